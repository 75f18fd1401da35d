/*
 * Power stage, brake, current and driver of an axis.
 */
#ifndef ODS_MOTOR_H
#define ODS_MOTOR_H

#include "ods_axis.h"
#include "ods_units.h"

#define ODS_MOTOR_CURRENT_STEP 8u /* 2003h and 2004h: the driver knows 32 steps of 8 each */

/* Whether the brake is controlled automatically (200Ch). */
int ods_motor_has_brake(const ods_axis_t *axis);

/* Whether the current is not yet that of standstill. */
int ods_motor_is_armed(const ods_axis_t *axis);

/* Hand the value at an offset to the driver if it is one of its parameters; or all of them, as after a reset. */
void ods_motor_set(const ods_node_t *node, const ods_axis_t *axis, uint32_t at);
void ods_motor_set_all(const ods_node_t *node, const ods_axis_t *axis);

void ods_motor_power_on(ods_axis_t *axis);

/* Also the brake falls. */
void ods_motor_power_off(ods_axis_t *axis);

/* Have the outputs told at the end of the turn if one has changed. */
void ods_motor_update(ods_node_t *node, const ods_axis_t *axis);

/* Tell the outputs that have changed. */
void ods_motor_put(const ods_node_t *node, ods_axis_t *axis);

/* ---- a tick ------------------------------------------------------------------------------------------------------ */

/* The current at standstill, in steps of the driver. */
uint8_t ods_motor_fade(ods_axis_t *axis);

/* What the driver does at the present speed, by thresholds of which at least one is not 0. */
uint8_t ods_motor_compare(const ods_axis_t *axis);

/* The current in motion, in steps of the driver. */
static inline uint8_t ods_motor_running(const ods_axis_t *axis)
{
    return (uint8_t)(axis->values->maximum_current / ODS_MOTOR_CURRENT_STEP + 1u);
}

static inline uint8_t ods_motor_choose_current(ods_axis_t *axis)
{
    if (axis->velocity == 0) {
        return ods_motor_fade(axis);
    }
    axis->still = 0;
    axis->faded_us = 0;
    return ods_motor_running(axis);
}

static inline uint8_t ods_motor_choose_driver(const ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    if ((values->smart_energy_threshold_speed | values->pwm_threshold_speed | values->dcstep_minimum_speed |
         values->fullstep_threshold_speed) != 0u) {
        return ods_motor_compare(axis);
    }
    return (axis->velocity != 0) ? ODS_DRIVER_COOL_STEP | ODS_DRIVER_HIGH_SPEED : 0u;
}

/* Of an axis with power. Has the outputs told, too. */
static inline void ods_motor_tick(ods_node_t *node, ods_axis_t *axis)
{
    const uint8_t current = ods_motor_choose_current(axis);
    const uint8_t driver = ods_motor_choose_driver(axis);
    const uint32_t driven = (axis->values->chopper_off_time != 0u) ? ODS_AXIS_DRIVEN : 0u;

    if ((current != axis->current) || (driver != axis->driver) || (driven != (axis->flags & ODS_AXIS_DRIVEN))) {
        axis->current = current;
        axis->driver = driver;
        axis->flags = (axis->flags & ~ODS_AXIS_DRIVEN) | driven;
        node->work |= ODS_WORK_OUTPUT;
    }
}

ODS_STATIC_ASSERT(answers_have_no_gaps, sizeof(ods_motor_answer_t) == 16u);

/* Have the steps of the tick made. Whether the hardware has something new to say. */
static inline int ods_motor_drive(const ods_port_t *port, ods_axis_t *axis)
{
    const ods_motor_demand_t demand = { axis->steps, (int32_t)(axis->velocity / ODS_PER_PPS) };
    const ods_motor_answer_t before = axis->answer;

    axis->steps = 0;
    if (port->motor == NULL) {
        return 0;
    }
    port->motor(port->context, axis->number, &demand, &axis->answer);
    return memcmp(&axis->answer, &before, sizeof before) != 0;
}

#endif
