/*
 * Where an axis is and how fast.
 */
#ifndef ODS_MOTION_H
#define ODS_MOTION_H

#include "ods_axis.h"
#include "ods_encoder.h"
#include "ods_units.h"

#define ODS_MOTION_FROM_ENCODER 0 /* 606Ah: the velocity is that of the encoder */

/* The power is off, nothing is demanded of the motor any more. */
static inline void ods_motion_halt(ods_axis_t *axis)
{
    axis->velocity = 0;
    axis->flags &= ~ODS_AXIS_MOVING;
}

/* Count from another position in microsteps, without moving. */
void ods_motion_set_position(ods_axis_t *axis, int32_t position);

/* The shaft may have been turned while the motor had no power. */
void ods_motion_start_from_encoder(ods_axis_t *axis);

/* The position leaves the range of 32 bits at one end and comes in at the other: what is demanded then. */
int64_t ods_motion_wrap(ods_axis_t *axis, int64_t demand);

/* Microsteps that were made, in either direction. */
static inline void ods_motion_count(ods_axis_values_t *values, int32_t steps)
{
    const uint32_t made = (steps < 0) ? 0u - (uint32_t)steps : (uint32_t)steps;
    const uint64_t counter = values->step_counter_value + made;
    values->step_counter_value = counter;
    values->step_counter_low = (uint32_t)counter;
    values->step_counter_high = (uint32_t)(counter >> 32);
}

/* A tick at a velocity; the distance is another one where a target is reached in it. */
static inline void ods_motion_move(ods_axis_t *axis, int64_t velocity, int64_t distance)
{
    uint32_t flags = axis->flags & ~ODS_AXIS_MOVING;

    if (distance != 0) {
        axis->position += distance;
        int64_t demand = axis->position / ODS_PER_MICROSTEP;
        if (demand != (int32_t)demand) {
            demand = ods_motion_wrap(axis, demand);
        }
        /* The difference of what is shown, so that motor and position stay together over the wrap, too. */
        axis->steps = (int32_t)((uint32_t)demand - (uint32_t)axis->demand);
        axis->demand = (int32_t)demand;
        flags &= ~ODS_AXIS_BACKWARDS;
        flags |= (distance < 0) ? ODS_AXIS_BACKWARDS : 0u;
        ods_motion_count(axis->values, axis->steps);
    }
    axis->velocity = velocity;
    axis->flags = flags | ((velocity != 0) ? ODS_AXIS_MOVING : 0u);
    ods_encoder_follow(axis, axis->demand);
}

/* Whether it is the encoder that tells how fast the axis is. */
static inline int ods_motion_is_measured(const ods_axis_t *axis)
{
    return ods_encoder_is_used(axis) && (axis->values->sensor_selection_code == ODS_MOTION_FROM_ENCODER);
}

/* What 606Ch shows from a tick on. */
static inline int32_t ods_motion_velocity(const ods_axis_t *axis)
{
    const int is_measured = (axis->flags & ODS_AXIS_MEASURED) != 0u;
    return ods_velocity_number(axis->values, is_measured ? axis->encoder.velocity : axis->velocity);
}

/* The same up to the next one. Parameters act only there; what may come between is that the power goes off. */
static inline int32_t ods_motion_last_velocity(const ods_axis_t *axis)
{
    return ((axis->flags & (ODS_AXIS_MEASURED | ODS_AXIS_MOVING)) != 0u) ? axis->values->velocity_actual_value : 0;
}

/* The values that say where the axis is, and how fast. */
static inline void ods_motion_show(ods_node_t *node, const ods_axis_t *axis, int32_t velocity)
{
    ods_axis_values_t *const values = axis->values;
    const int32_t actual = axis->encoder.position; /* without an encoder in use the ramp tells */

    if ((values->position_demand_value != axis->demand) || (values->position_actual_value != actual) ||
        (values->velocity_actual_value != velocity)) {
        ods_axis_changed(node, axis);
    }
    values->position_demand_value = axis->demand;
    values->position_actual_internal_value = actual;
    values->position_actual_value = actual;
    values->velocity_actual_value = velocity;
}

#endif
