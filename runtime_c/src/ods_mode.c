#include "ods_mode.h"

#include "ods_cyclic.h"
#include "ods_fsa.h"
#include "ods_homing.h"
#include "ods_limits.h"
#include "ods_motion.h"
#include "ods_ramp.h"
#include "ods_units.h"

/* Bits of the controlword that belong to modes (CiA 402). */
#define CONTROL_NEW_SET_POINT 0x0010u
#define CONTROL_RELATIVE 0x0040u
#define CONTROL_HALT 0x0100u

/* 6067h: these windows are not used. */
#define NO_WINDOW 0u
#define NO_WINDOW_EITHER 0xFFFFFFFFu

/* 60F2h: what a relative target counts from. */
#define FROM_DEMAND 1u
#define FROM_ACTUAL 2u

#define US_PER_WAIT 32u /* 2015h */

/* ---- set-points -------------------------------------------------------------------------------------------------- */

static void forget(ods_axis_t *axis)
{
    axis->target = 0;
    axis->inside = 0;
    axis->flags &= ~(ODS_AXIS_HAS_TARGET | ODS_AXIS_CLAMPED | ODS_AXIS_ACKNOWLEDGED | ODS_AXIS_REACHED);
    ods_cyclic_reset(axis);
}

/* Go to the position allowed that is nearest to a target. */
static void choose_target(ods_axis_t *axis, int64_t target)
{
    axis->target = ods_limits_clamp(axis, target);
    axis->flags &= ~ODS_AXIS_CLAMPED;
    if (axis->target != target) {
        axis->flags |= ODS_AXIS_CLAMPED;
    }
}

/* What a relative target counts from. */
static int32_t base(const ods_axis_t *axis)
{
    const uint32_t option = axis->values->positioning_option_code;
    if (option == FROM_ACTUAL) {
        return axis->values->position_actual_value;
    }
    if ((option == FROM_DEMAND) || ((axis->flags & ODS_AXIS_HAS_TARGET) == 0u)) {
        return axis->values->position_demand_value;
    }
    return axis->target;
}

/* An edge of new set-point replaces the target of a running move. */
static void set_point(ods_axis_t *axis, int is_relative)
{
    choose_target(axis, (int64_t)axis->values->target_position + (is_relative ? base(axis) : 0));
    axis->inside = 0;
    axis->flags &= ~ODS_AXIS_REACHED;
    axis->flags |= ODS_AXIS_HAS_TARGET | ODS_AXIS_ACKNOWLEDGED;
    axis->fresh = (int8_t)ODS_MODE_PROFILE_POSITION;
}

static inline int is_at_target(const ods_axis_t *axis)
{
    return axis->position == (int64_t)axis->target * ODS_PER_MICROSTEP;
}

/* ---- events ------------------------------------------------------------------------------------------------------ */

void ods_mode_enabled(ods_axis_t *axis)
{
    forget(axis);
    ods_homing_enabled(axis);
    axis->wait = 0;
}

void ods_mode_control(ods_axis_t *axis, uint32_t word, uint32_t before)
{
    if (axis->values->modes_of_operation == (int8_t)ODS_MODE_HOMING) {
        ods_homing_control(axis, word, before);
    }
    if ((word & CONTROL_NEW_SET_POINT) == 0u) {
        axis->flags &= ~ODS_AXIS_ACKNOWLEDGED;
    } else if (
        ((before & CONTROL_NEW_SET_POINT) == 0u) && ods_fsa_is_enabled(axis) &&
        (axis->values->modes_of_operation == (int8_t)ODS_MODE_PROFILE_POSITION)) {
        set_point(axis, (word & CONTROL_RELATIVE) != 0u);
    }
}

int ods_mode_target_written(ods_axis_t *axis, ods_mode_t mode)
{
    const int was_following = axis->cyclic.is_following != 0u;
    if (!ods_fsa_is_enabled(axis) || (axis->values->modes_of_operation != (int8_t)mode)) {
        return 0;
    }
    ods_cyclic_written(axis);
    axis->fresh = (int8_t)mode;
    return !was_following;
}

void ods_mode_offset_written(ods_axis_t *axis)
{
    if (axis->cyclic.is_following != 0u) {
        ods_cyclic_restart(axis);
    }
}

void ods_mode_window_written(ods_axis_t *axis)
{
    axis->inside = 0;
    axis->flags &= ~ODS_AXIS_REACHED;
}

/* ---- ramps ------------------------------------------------------------------------------------------------------- */

/* The slow-down ramp of the mode in force. A mode without one leaves that of the mode before. */
static void choose_slow_down_ramp(const ods_node_t *node, ods_axis_t *axis)
{
    for (uint32_t n = 0; n < node->device->mode_count; n++) {
        const ods_mode_row_t *const row = &node->device->modes[n];
        if ((row->code == axis->values->modes_of_operation_display) && (row->slow_down_ramp != ODS_NOWHERE)) {
            axis->slow_down_ramp = row->slow_down_ramp;
        }
    }
}

void ods_mode_reset(const ods_node_t *node, ods_axis_t *axis)
{
    axis->slow_down_ramp = ODS_NOWHERE;
    ods_mode_ramp_written(axis);
    choose_slow_down_ramp(node, axis);
}

static int64_t slow_down(const ods_axis_t *axis, int64_t velocity)
{
    if (axis->slow_down_ramp == ODS_NOWHERE) {
        return 0;
    }
    const void *const deceleration = (const uint8_t *)axis->values + axis->slow_down_ramp;
    return ods_ramp_slow_down(velocity, ods_acceleration(axis->values, *(const uint32_t *)deceleration));
}

/* What the bus says of the ramp of profile position, in the units of a tick. */
static inline ods_ramp_t ramp_of(const ods_axis_values_t *values)
{
    const ods_ramp_t ramp = {
        ods_velocity(values, values->profile_start_velocity),
        ods_acceleration(values, values->profile_a1),
        ods_velocity(values, values->profile_v1),
        ods_acceleration(values, values->profile_acceleration),
        ods_velocity(values, values->profile_velocity),
        ods_acceleration(values, values->profile_deceleration),
        ods_acceleration(values, values->profile_d1),
        ods_velocity(values, values->end_velocity),
    };
    return ramp;
}

static int64_t turn(const ods_axis_values_t *values, int64_t velocity)
{
    return ods_ramp_turn(
        velocity,
        ods_velocity(values, values->target_velocity),
        ods_acceleration(values, values->profile_acceleration),
        ods_velocity(values, values->profile_start_velocity),
        ods_velocity(values, values->end_velocity));
}

/* ---- a tick ------------------------------------------------------------------------------------------------------ */

/* The mode that was asked for takes over. */
ODS_RARE static void change(ods_node_t *node, ods_axis_t *axis)
{
    axis->values->modes_of_operation_display = axis->values->modes_of_operation;
    choose_slow_down_ramp(node, axis);
    ods_homing_forget(axis);
    if ((axis->fresh == 0) || (axis->fresh != axis->values->modes_of_operation)) {
        forget(axis);
    }
    ods_axis_changed(node, axis);
}

/* On the way to a target that is not far, or is yet to be found far. */
ODS_RARE static int64_t come_near(ods_axis_t *axis, int64_t rest, int64_t *way)
{
    const ods_ramp_t ramp = ramp_of(axis->values);
    int arrives;
    const int64_t velocity = ods_ramp_advance(&ramp, axis->velocity, rest, &arrives);
    if (axis->far == INT64_MAX) {
        axis->far = ods_ramp_far(&ramp);
    }
    *way = arrives ? rest : velocity;
    return velocity;
}

/*
 * Profile position, on the way to a target: the velocity of this tick; the way, which is as far unless the axis
 * arrives. A target that is far says nothing to the ramp but the direction.
 */
static inline int64_t approach(ods_axis_t *axis, int64_t *way)
{
    const int64_t rest = (int64_t)axis->target * ODS_PER_MICROSTEP - axis->position;
    const int64_t distance = (rest < 0) ? -rest : rest;
    const int64_t speed = (rest < 0) ? -axis->velocity : axis->velocity;
    const ods_ramp_t ramp = ramp_of(axis->values);

    if ((distance < axis->far) || (speed < 0) || (speed > ramp.v_max)) {
        return come_near(axis, rest, way);
    }
    const int64_t faster = ods_ramp_faster(&ramp, speed);
    *way = (rest < 0) ? -faster : faster;
    return *way;
}

/* What the mode makes of a velocity, if it has anything to do. */
static int64_t step(ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    switch (values->modes_of_operation_display) {
    case ODS_MODE_PROFILE_VELOCITY:
        return turn(values, axis->velocity);
    case ODS_MODE_HOMING:
        if (ods_homing_runs(axis)) {
            return ods_homing_step(axis, axis->velocity);
        }
        break;
    case ODS_MODE_CYCLIC_SYNCHRONOUS_POSITION:
        if (axis->cyclic.is_following != 0u) {
            choose_target(axis, ods_cyclic_target_position(values));
            return ods_cyclic_position(axis, axis->target);
        }
        break;
    case ODS_MODE_CYCLIC_SYNCHRONOUS_VELOCITY:
        if (axis->cyclic.is_following != 0u) {
            return ods_cyclic_velocity(axis, ods_cyclic_target_velocity(values), axis->velocity);
        }
        break;
    default:
        break;
    }
    return slow_down(axis, axis->velocity);
}

/* The axis does not obey its mode: it rests, or is halted or otherwise brought to rest. */
ODS_RARE static int64_t stop(ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    if (axis->cyclic.is_following != 0u) {
        ods_cyclic_restart(axis);
    }
    if (axis->stop == (uint8_t)ODS_STOP_QUICK_STOP_RAMP) {
        return ods_ramp_slow_down(axis->velocity, ods_acceleration(values, values->quick_stop_deceleration));
    }
    return slow_down(axis, axis->velocity);
}

/* Whether a mode is one whose moves wait for the end of a pause. */
static int is_profile(int8_t mode)
{
    return (mode == (int8_t)ODS_MODE_PROFILE_POSITION) || (mode == (int8_t)ODS_MODE_PROFILE_VELOCITY);
}

/* The velocity of this tick; the way, where it is another one. */
static inline int64_t choose_velocity(ods_axis_t *axis, int64_t *way)
{
    const ods_axis_values_t *const values = axis->values;
    const int8_t mode = values->modes_of_operation_display;
    /* Bit 8, which homing ignores (manual, section 8.2.1). */
    const int is_halted = ((values->controlword & CONTROL_HALT) != 0u) && (mode != (int8_t)ODS_MODE_HOMING);
    const int is_pausing = (axis->velocity == 0) && (axis->wait != 0u);

    if (is_pausing) {
        axis->wait--;
    }
    if (!ods_fsa_is_enabled(axis) || is_halted) {
        *way = stop(axis);
    } else if (is_pausing && is_profile(mode)) {
        *way = 0;
    } else if ((mode == (int8_t)ODS_MODE_PROFILE_POSITION) && ((axis->flags & ODS_AXIS_HAS_TARGET) != 0u)) {
        return approach(axis, way);
    } else {
        *way = step(axis);
    }
    return *way;
}

static inline void move(ods_axis_t *axis)
{
    int64_t way;
    int64_t velocity = choose_velocity(axis, &way);

    if (ods_limits_block(axis, way)) {
        velocity = 0;
        way = 0;
    }
    if ((velocity == 0) && (axis->velocity != 0)) {
        axis->wait = (uint16_t)((axis->values->ramp_wait_time * US_PER_WAIT + ODS_TICK_US - 1u) / ODS_TICK_US);
    }
    ods_motion_move(axis, velocity, way);
}

/* 6067h and 6068h, or the ramp has arrived where no window is in use. */
static inline int is_in_position(ods_axis_t *axis)
{
    const uint32_t window = axis->values->position_window;
    if ((window == NO_WINDOW) || (window == NO_WINDOW_EITHER)) {
        return (axis->velocity == 0) && is_at_target(axis);
    }
    const int64_t lag = (int64_t)axis->encoder.position - axis->target;
    if ((lag > window) || (-lag > window)) {
        axis->inside = 0;
        return 0;
    }
    if (axis->inside < axis->values->position_window_time) {
        axis->inside++;
        return 0;
    }
    return 1;
}

/* Whether the target is reached. */
static inline int judge(ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    switch (values->modes_of_operation_display) {
    case ODS_MODE_PROFILE_POSITION:
        return ((axis->flags & ODS_AXIS_HAS_TARGET) != 0u) ? is_in_position(axis) : (axis->velocity == 0);
    case ODS_MODE_PROFILE_VELOCITY:
        return axis->velocity == ods_velocity(values, values->target_velocity);
    default:
        return 0;
    }
}

void ods_mode_tick(ods_node_t *node, ods_axis_t *axis)
{
    if (axis->values->modes_of_operation != axis->values->modes_of_operation_display) {
        change(node, axis);
    }
    if (axis->values->modes_of_operation_display == (int8_t)ODS_MODE_HOMING) {
        ods_homing_begin(node, axis, ods_fsa_is_enabled(axis));
    }
    move(axis);
    axis->flags &= ~(ODS_AXIS_REACHED | ODS_AXIS_CALLED);
    axis->fresh = 0;
    if (judge(axis)) {
        axis->flags |= ODS_AXIS_REACHED;
    }
}

int ods_mode_is_armed(const ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    const int is_reached = (axis->flags & ODS_AXIS_REACHED) != 0u;

    if (values->modes_of_operation != values->modes_of_operation_display) {
        return 1;
    }
    if (!ods_fsa_is_enabled(axis)) {
        return 0;
    }
    if (axis->wait != 0u) {
        return 1;
    }
    switch (values->modes_of_operation_display) {
    case ODS_MODE_PROFILE_POSITION:
        return ((axis->flags & ODS_AXIS_HAS_TARGET) != 0u) && !(is_reached && is_at_target(axis));
    case ODS_MODE_PROFILE_VELOCITY:
        return !is_reached;
    case ODS_MODE_HOMING:
        return ods_homing_runs(axis);
    case ODS_MODE_CYCLIC_SYNCHRONOUS_POSITION:
    case ODS_MODE_CYCLIC_SYNCHRONOUS_VELOCITY:
        return axis->cyclic.is_following != 0u;
    default:
        return 0;
    }
}
