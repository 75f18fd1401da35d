#include "ods_axis.h"

#include "ods_emcy.h"
#include "ods_encoder.h"
#include "ods_fsa.h"
#include "ods_limits.h"
#include "ods_mode.h"
#include "ods_motion.h"
#include "ods_motor.h"
#include "ods_units.h"

/* Bits of the statusword 6041h (CiA 402) beside those of ods_axis_t.flags. */
#define STATUS_VOLTAGE_ENABLED 0x0010u
#define STATUS_WARNING 0x0080u
#define STATUS_REMOTE 0x0200u
#define STATUS_INTERNAL_LIMIT 0x0800u
#define STATUS_FOLLOWING_ERROR 0x2000u

/* Conditions that the axis finds itself. */
#define STALL (1u << ODS_CONDITION_STALL)
#define FOLLOWING_ERROR (1u << ODS_CONDITION_FOLLOWING_ERROR)

/* ---- what is shown ----------------------------------------------------------------------------------------------- */

/* What the statusword tells of conditions of the axis. */
ODS_RARE static uint32_t status_by_conditions(const ods_node_t *node, const ods_axis_t *axis, uint32_t status)
{
    const int8_t mode = axis->values->modes_of_operation_display;
    uint32_t told = status;
    if ((axis->conditions & 1u << ODS_CONDITION_UNDERVOLTAGE) != 0u) {
        told &= ~STATUS_VOLTAGE_ENABLED;
    }
    if (ods_emcy_is_warned(node, axis->conditions)) {
        told |= STATUS_WARNING;
    }
    if ((axis->conditions & (ODS_LIMITS_POSITIVE | ODS_LIMITS_NEGATIVE)) != 0u) {
        told |= STATUS_INTERNAL_LIMIT;
    }
    if ((mode == (int8_t)ODS_MODE_CYCLIC_SYNCHRONOUS_POSITION) && ((axis->conditions & FOLLOWING_ERROR) != 0u)) {
        told |= STATUS_FOLLOWING_ERROR;
    }
    return told;
}

static inline uint32_t status_of(const ods_node_t *node, const ods_axis_t *axis)
{
    uint32_t status =
        axis->shown_state | (axis->flags & (ODS_AXIS_MOVING | ODS_AXIS_BACKWARDS)) | ods_mode_status(axis);
    if ((node->emcy.conditions & 1u << ODS_CONDITION_SHUTDOWN_SWITCH) == 0u) {
        status |= STATUS_VOLTAGE_ENABLED;
    }
    if (node->common->tmcl_mode == 0u) {
        status |= STATUS_REMOTE;
    }
    return (axis->conditions == 0u) ? status : status_by_conditions(node, axis, status);
}

static inline void update_status(ods_node_t *node, const ods_axis_t *axis)
{
    const uint16_t status = (uint16_t)status_of(node, axis);
    if (axis->values->statusword != status) {
        axis->values->statusword = status;
        ods_axis_changed(node, axis);
    }
}

/* Statusword, positions and outputs follow the state of the axis and of the module. */
static void update(ods_node_t *node, const ods_axis_t *axis)
{
    ods_motion_show(node, axis, ods_motion_last_velocity(axis));
    update_status(node, axis);
    ods_motor_update(node, axis);
}

void ods_axis_update_all(ods_node_t *node)
{
    for (uint32_t n = 0; n < node->device->axes; n++) {
        update(node, &node->axes[n]);
    }
}

/* ---- events ------------------------------------------------------------------------------------------------------ */

void ods_axis_init(ods_node_t *node, uint8_t axis)
{
    memset(&node->axes[axis], 0, sizeof node->axes[axis]);
    node->axes[axis].values = ods_axis_values(node, axis);
    node->axes[axis].number = axis;
}

void ods_axis_reset(ods_node_t *node, uint8_t axis)
{
    ods_axis_t *const own = &node->axes[axis];
    /* What the hardware says, and was told last, is not ours to forget. */
    const ods_motor_answer_t answer = own->answer;
    const uint32_t faults = own->faults;
    const uint32_t outputs = own->outputs;

    ods_axis_init(node, axis);
    own->answer = answer;
    own->faults = faults;
    own->outputs = outputs;
    ods_axis_wake(own);
    ods_fsa_reset(node, own);
    ods_encoder_reset(own);
    ods_mode_reset(node, own);
    ods_motor_set_all(node, own);
    update(node, own);
}

void ods_axis_written(ods_node_t *node, uint32_t instance, uint32_t effect, uint32_t at)
{
    if (!ods_is_axis_instance(node, instance)) {
        return;
    }
    ods_axis_t *const axis = &node->axes[instance - node->od->scope_instances[ODS_SCOPE_AXIS]];
    int shows = 0; /* something before the next tick */
    if (!ods_timer_armed(node, ODS_TIMER_TICK)) {
        ods_tick_arm(node);
    }
    ods_axis_wake(axis);
    switch (effect) {
    case ODS_EFFECT_CONTROLWORD:
        shows = ods_fsa_command(node, axis, axis->values->controlword);
        break;
    case ODS_EFFECT_MODE:
        ods_fsa_listen(axis);
        break;
    case ODS_EFFECT_TARGET_POSITION:
        shows = ods_mode_target_written(axis, ODS_MODE_CYCLIC_SYNCHRONOUS_POSITION);
        break;
    case ODS_EFFECT_TARGET_VELOCITY:
        shows = ods_mode_target_written(axis, ODS_MODE_CYCLIC_SYNCHRONOUS_VELOCITY);
        break;
    case ODS_EFFECT_SET_POINT_OFFSET:
        ods_mode_offset_written(axis);
        break;
    case ODS_EFFECT_RAMP_PARAMETER:
        ods_mode_ramp_written(axis);
        break;
    case ODS_EFFECT_UNIT_SELECTION:
        ods_mode_ramp_written(axis);
        break;
    case ODS_EFFECT_POSITION_WINDOW:
        ods_mode_window_written(axis);
        shows = 1;
        break;
    case ODS_EFFECT_BRAKE:
        node->work |= ODS_WORK_OUTPUT;
        break;
    case ODS_EFFECT_ENCODER_PARAMETER:
    case ODS_EFFECT_MICROSTEP_RESOLUTION:
        ods_encoder_parameter_written(axis);
        ods_motor_set(node, axis, at);
        break;
    default:
        ods_motor_set(node, axis, at);
        break;
    }
    if (shows) {
        update(node, axis);
    }
}

void ods_axis_react(ods_node_t *node, uint8_t axis, uint8_t reaction)
{
    ods_axis_t *const own = &node->axes[axis];
    ods_axis_wake(own);
    if (reaction == (uint8_t)ODS_REACTION_FAULT_RAMP) {
        ods_fsa_fault(node, own, 0);
    } else if (reaction == (uint8_t)ODS_REACTION_FAULT_OFF) {
        ods_fsa_fault(node, own, 1);
    }
    update(node, own);
}

void ods_axis_network_stopped(ods_node_t *node)
{
    for (uint32_t n = 0; n < node->device->axes; n++) {
        ods_axis_wake(&node->axes[n]);
        ods_fsa_network_stopped(node, &node->axes[n]);
        update(node, &node->axes[n]);
    }
}

void ods_axis_put_all(const ods_node_t *node)
{
    for (uint32_t n = 0; n < node->device->axes; n++) {
        ods_motor_put(node, &node->axes[n]);
    }
}

/* ---- time -------------------------------------------------------------------------------------------------------- */

/* Stop on stall: faster than 20A4h, and the load has stopped the motor. */
static inline int is_stalled(const ods_axis_t *axis)
{
    const uint32_t threshold = axis->values->stop_on_stall;
    const int64_t speed = (axis->velocity < 0) ? -axis->velocity : axis->velocity;
    return (threshold != 0u) && (axis->answer.load == 0u) && (speed > ods_velocity(axis->values, threshold));
}

/* Following error: the encoder lags the ramp by more than 6065h. */
static inline int is_behind(const ods_axis_t *axis)
{
    const uint32_t window = axis->values->following_error_window;
    const int64_t lag = (int32_t)((uint32_t)axis->demand - (uint32_t)axis->encoder.position); /* positions wrap */
    return (window != 0u) && ((lag > window) || (-lag > window));
}

/* Conditions that the hardware reports, and those that the axis finds itself but for limits. */
static inline uint32_t find_conditions(const ods_axis_t *axis)
{
    uint32_t conditions = axis->faults | axis->answer.faults;
    if ((axis->flags & ODS_AXIS_POWERED) != 0u) {
        conditions |= is_stalled(axis) ? STALL : 0u;
        conditions |= is_behind(axis) ? FOLLOWING_ERROR : 0u;
    }
    return conditions;
}

static void show_conditions(const ods_node_t *node, const ods_axis_t *axis)
{
    axis->values->driver_error_flags = ods_emcy_driver_flags(node, axis->conditions);
}

static inline void put_conditions(ods_node_t *node, const ods_axis_t *axis, uint32_t conditions)
{
    if (conditions != axis->conditions) {
        ods_emcy_set_axis(node, axis->number, conditions);
        show_conditions(node, axis);
    }
}

/* What the hardware says, and what is only shown. */
static void hear(ods_node_t *node, ods_axis_t *axis)
{
    ods_axis_values_t *const values = axis->values;
    axis->flags &= ~(ODS_AXIS_NEWS | ODS_AXIS_MEASURED);
    axis->flags |= ods_motion_is_measured(axis) ? ODS_AXIS_MEASURED : 0u;
    ods_limits_sample(node, axis);
    ods_encoder_sample(axis);
    if ((axis->encoder.velocity != 0) || (axis->encoder.has_pulse != 0u)) {
        axis->flags |= ODS_AXIS_NEWS; /* even if nothing follows */
    }
    show_conditions(node, axis);
    values->actual_load_value = axis->answer.load;
    values->pwm_scale_value = axis->answer.pwm_scale;
    values->measured_velocity = ods_velocity_number(values, (int64_t)axis->answer.velocity * ODS_PER_PPS);
    values->microstep_resolution_display = values->microstep_resolution;
    values->acceleration_dimension_index = ods_acceleration_index(values);
}

static void tick(ods_node_t *node, ods_axis_t *axis)
{
    if ((axis->flags & ODS_AXIS_NEWS) != 0u) {
        hear(node, axis);
    }
    const uint32_t found = find_conditions(axis);
    put_conditions(node, axis, found | axis->limits);
    if (axis->phase != (uint8_t)ODS_PHASE_NONE) {
        ods_fsa_tick(node, axis);
        node->work |= ODS_WORK_OUTPUT;
    }
    ods_mode_tick(node, axis);
    ods_motion_show(node, axis, ods_motion_velocity(axis));
    ods_limits_check(axis);
    put_conditions(node, axis, found | axis->limits);
    if ((axis->flags & ODS_AXIS_POWERED) != 0u) {
        ods_motor_tick(node, axis);
    }
    update_status(node, axis);
}

/* Whether there is a condition that only the axis itself finds, and has to look at until it ends. */
static inline int has_found(const ods_axis_t *axis)
{
    return (axis->conditions & ~(axis->faults | axis->answer.faults) & (STALL | FOLLOWING_ERROR)) != 0u;
}

/* Whether the next tick can change anything. */
static inline int is_armed(const ods_axis_t *axis)
{
    return ((axis->flags & ODS_AXIS_MOVING) != 0u) || (axis->phase != (uint8_t)ODS_PHASE_NONE) ||
           (axis->encoder.velocity != 0) || has_found(axis) || ods_mode_is_armed(axis) || ods_motor_is_armed(axis);
}

void ods_axis_tick_all(ods_node_t *node)
{
    const uint32_t axes = node->device->axes;
    int armed = 0;

    for (uint32_t n = 0; n < axes; n++) {
        if ((node->axes[n].flags & ODS_AXIS_RESTS) == 0u) {
            tick(node, &node->axes[n]);
        }
    }
    for (uint32_t n = 0; n < axes; n++) {
        ods_axis_t *const axis = &node->axes[n];
        if (ods_motor_drive(node->port, axis)) {
            ods_axis_wake(axis);
            armed = 1;
        } else if (((axis->flags & ODS_AXIS_RESTS) == 0u) && is_armed(axis)) {
            armed = 1;
        } else {
            axis->flags |= ODS_AXIS_RESTS;
        }
    }
    if (armed) {
        ods_tick_arm(node);
    }
}
