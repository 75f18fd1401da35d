#include "ods_motor.h"

#define TICKS_PER_SETTING_DELAY 10u /* 2089h counts 10 ms */
#define FADE_STEP_US 16384u /* 2^18 clocks of 16 MHz: a unit of 20B9h, the time in which the current falls by a step */

/* Outputs as they were told: an octet for each, in the order of ods_output_t. */
#define OUTPUTS 4u
#define OUTPUT_AT(output) (8u * ((uint32_t)(output) - (uint32_t)ODS_OUTPUT_POWER))

ODS_STATIC_ASSERT(outputs_of_an_axis_are_the_last_ones, ODS_OUTPUTS == ODS_OUTPUT_POWER + OUTPUTS);

int ods_motor_has_brake(const ods_axis_t *axis)
{
    return (axis->values->brake_current_feed_apply | axis->values->brake_current_feed_release) != 0;
}

/* ---- parameters -------------------------------------------------------------------------------------------------- */

/* A number as it is used: signed where its type is. */
static int32_t number_at(const void *value, uint8_t type)
{
    const int is_signed = ODS_OD_IS_SIGNED(type);
    switch (type & 3u) {
    case 0:
        return is_signed ? *(const int8_t *)value : *(const uint8_t *)value;
    case 1:
        return is_signed ? *(const int16_t *)value : *(const uint16_t *)value;
    default:
        return *(const int32_t *)value;
    }
}

static void set(const ods_node_t *node, const ods_axis_t *axis, const ods_motor_parameter_row_t *row)
{
    const void *const value = (const uint8_t *)axis->values + row->field.at;
    if (node->port->motor_set != NULL) {
        node->port->motor_set(node->port->context, axis->number, row->index, number_at(value, row->field.type));
    }
}

void ods_motor_set(const ods_node_t *node, const ods_axis_t *axis, uint32_t at)
{
    const ods_motor_parameter_row_t *row = node->device->motor_parameters;
    uint32_t left = node->device->motor_parameter_count;
    while ((left != 0u) && (row->field.at != at)) {
        row++;
        left--;
    }
    if (left != 0u) {
        set(node, axis, row);
    }
}

void ods_motor_set_all(const ods_node_t *node, const ods_axis_t *axis)
{
    for (uint32_t n = 0; n < node->device->motor_parameter_count; n++) {
        set(node, axis, &node->device->motor_parameters[n]);
    }
}

/* ---- current ----------------------------------------------------------------------------------------------------- */

static uint8_t standby(const ods_axis_t *axis)
{
    return (uint8_t)(axis->values->standby_current / ODS_MOTOR_CURRENT_STEP + 1u);
}

static uint32_t settling(const ods_axis_t *axis)
{
    return axis->values->setting_delay * TICKS_PER_SETTING_DELAY;
}

/* That of standstill comes some time after it, and is reached step by step (2089h, 20B9h). */
uint8_t ods_motor_fade(ods_axis_t *axis)
{
    const uint32_t settled = settling(axis);

    axis->still += (axis->still <= settled) ? 1u : 0u;
    if (axis->still <= settled) {
        axis->faded_us = 0;
        return ods_motor_running(axis);
    }
    if ((axis->current <= standby(axis)) || (axis->values->power_down_ramp == 0u)) {
        return standby(axis);
    }
    const uint32_t step = FADE_STEP_US * axis->values->power_down_ramp;
    axis->faded_us += ODS_TICK_US;
    if (axis->faded_us < step) {
        return axis->current;
    }
    axis->faded_us -= step;
    return (uint8_t)(axis->current - 1u);
}

int ods_motor_is_armed(const ods_axis_t *axis)
{
    return ((axis->flags & ODS_AXIS_POWERED) != 0u) &&
           ((axis->still <= settling(axis)) || (axis->current != standby(axis)));
}

/* ---- driver ------------------------------------------------------------------------------------------------------ */

uint8_t ods_motor_compare(const ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    const int64_t speed = (axis->velocity < 0) ? -axis->velocity : axis->velocity;
    uint32_t driver = 0;

    if (speed > ods_velocity(values, values->smart_energy_threshold_speed)) {
        driver |= ODS_DRIVER_COOL_STEP;
    }
    if (speed < ods_velocity(values, values->pwm_threshold_speed)) {
        driver |= ODS_DRIVER_STEALTH_CHOP;
    }
    if ((values->dcstep_minimum_speed != 0u) && (speed >= ods_velocity(values, values->dcstep_minimum_speed))) {
        driver |= ODS_DRIVER_DC_STEP;
    }
    if (speed > ods_velocity(values, values->fullstep_threshold_speed)) {
        driver |= ODS_DRIVER_HIGH_SPEED;
    }
    return (uint8_t)driver;
}

/* ---- power ------------------------------------------------------------------------------------------------------- */

void ods_motor_power_on(ods_axis_t *axis)
{
    axis->flags |= ODS_AXIS_POWERED | ((axis->values->chopper_off_time != 0u) ? ODS_AXIS_DRIVEN : 0u);
    axis->still = 0;
    axis->faded_us = 0;
    axis->current = ods_motor_running(axis);
}

void ods_motor_power_off(ods_axis_t *axis)
{
    axis->flags &= ~(ODS_AXIS_POWERED | ODS_AXIS_RELEASED | ODS_AXIS_DRIVEN);
    axis->driver = 0;
}

/* ---- the port ---------------------------------------------------------------------------------------------------- */

static inline uint32_t outputs(const ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    const int is_powered = (axis->flags & ODS_AXIS_POWERED) != 0u;
    const int is_released = (axis->flags & ODS_AXIS_RELEASED) != 0u;
    const uint32_t brake = is_released ? values->brake_current_feed_release : values->brake_current_feed_apply;
    const uint32_t current = ((axis->flags & ODS_AXIS_DRIVEN) != 0u) ? axis->current : 0u;

    return (is_powered ? 1u : 0u) << OUTPUT_AT(ODS_OUTPUT_POWER) | brake << OUTPUT_AT(ODS_OUTPUT_BRAKE) |
           current << OUTPUT_AT(ODS_OUTPUT_CURRENT) | (uint32_t)axis->driver << OUTPUT_AT(ODS_OUTPUT_DRIVER);
}

void ods_motor_update(ods_node_t *node, const ods_axis_t *axis)
{
    if (outputs(axis) != axis->outputs) {
        node->work |= ODS_WORK_OUTPUT;
    }
}

void ods_motor_put(const ods_node_t *node, ods_axis_t *axis)
{
    const uint32_t now = outputs(axis);
    const uint32_t changed = now ^ axis->outputs;

    axis->outputs = now;
    if (node->port->output == NULL) {
        return;
    }
    for (uint32_t n = 0; n < OUTPUTS; n++) {
        if (((changed >> (8u * n)) & 0xFFu) != 0u) {
            node->port->output(
                node->port->context,
                (ods_output_t)((uint32_t)ODS_OUTPUT_POWER + n),
                axis->number,
                (now >> (8u * n)) & 0xFFu);
        }
    }
}
