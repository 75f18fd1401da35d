#include "ods_fsa.h"

#include "ods_emcy.h"
#include "ods_mode.h"
#include "ods_motion.h"
#include "ods_motor.h"

/* Quick stop option codes (605Ah, CiA 402). */
#define OFF_ON_MODE_RAMP 1
#define STAY_ON_MODE_RAMP 5
#define STAY_ON_QUICK_STOP_RAMP 6

#define FROM_ENCODER 0x01u /* 200Bh:03 */

/* ---- states ------------------------------------------------------------------------------------------------------ */

/* State or phase has changed: whether the axis obeys its mode follows from them. */
static void find_enabled(ods_axis_t *axis)
{
    axis->flags &= ~(ODS_AXIS_ENABLED | ODS_AXIS_DEAF);
    if ((axis->state == (uint8_t)ODS_PDS_STATE_OPERATION_ENABLED) && (axis->phase == (uint8_t)ODS_PHASE_NONE)) {
        axis->flags |= ODS_AXIS_ENABLED;
    }
}

static void enter(const ods_node_t *node, ods_axis_t *axis, uint8_t state)
{
    axis->state = state;
    axis->shown_state = 0;
    for (uint32_t n = 0; n < node->device->pds_state_count; n++) {
        if (node->device->pds_states[n].state == state) {
            axis->shown_state = node->device->pds_states[n].value;
        }
    }
    find_enabled(axis);
}

/* Where a command or an event leads from the present state; ODS_NONE: nowhere. */
static uint8_t end_of(const ods_node_t *node, const ods_axis_t *axis, uint8_t by)
{
    for (uint32_t n = 0; n < node->device->pds_transition_count; n++) {
        const ods_pds_transition_row_t *const row = &node->device->pds_transitions[n];
        if ((row->from == axis->state) && (row->by == by)) {
            return row->to;
        }
    }
    return ODS_NONE;
}

/* Take the transition that an event leads to, if there is one. */
static int follow(const ods_node_t *node, ods_axis_t *axis, ods_pds_trigger_t event)
{
    const uint8_t end = end_of(node, axis, (uint8_t)event);
    if (end == ODS_NONE) {
        return 0;
    }
    enter(node, axis, end);
    return 1;
}

static int is_staying(const ods_axis_t *axis)
{
    return (axis->quick_stop == STAY_ON_MODE_RAMP) || (axis->quick_stop == STAY_ON_QUICK_STOP_RAMP);
}

/* ---- phases ------------------------------------------------------------------------------------------------------ */

static void end_phases(ods_axis_t *axis)
{
    axis->phase = ODS_PHASE_NONE;
    axis->stop = ODS_STOP_NONE;
    find_enabled(axis);
}

static void power_off(ods_axis_t *axis)
{
    end_phases(axis);
    ods_motor_power_off(axis);
    ods_motion_halt(axis);
}

static void enabled(const ods_node_t *node, ods_axis_t *axis)
{
    end_phases(axis);
    enter(node, axis, ODS_PDS_STATE_OPERATION_ENABLED);
    ods_mode_enabled(axis);
}

/* The brake holds the load, the power stage may go off. */
static void held(const ods_node_t *node, ods_axis_t *axis)
{
    power_off(axis);
    if (axis->state == (uint8_t)ODS_PDS_STATE_OPERATION_ENABLED) {
        enter(node, axis, axis->goal);
    } else if (!follow(node, axis, ODS_PDS_EVENT_QUICK_STOP_DONE)) {
        (void)follow(node, axis, ODS_PDS_EVENT_FAULT_REACTION_DONE);
    }
}

/* A phase begins, which takes so many ticks. The one that is worked off now is none of them. */
static void begin(ods_node_t *node, ods_axis_t *axis, ods_phase_t phase, uint16_t ticks)
{
    axis->phase = (uint8_t)phase;
    axis->delay = ticks;
    axis->begun = node->now;
    find_enabled(axis);
    if (ticks != 0u) {
        ods_tick_arm(node);
    }
}

/* Go from phase to phase as far as they take no time. */
static void proceed(ods_node_t *node, ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    const int has_brake = ods_motor_has_brake(axis);

    while (axis->delay == 0u) {
        switch (axis->phase) {
        case ODS_PHASE_POWERING:
            axis->flags |= ODS_AXIS_RELEASED;
            begin(node, axis, ODS_PHASE_RELEASING, has_brake ? values->brake_delay_times_release : 0u);
            break;
        case ODS_PHASE_RELEASING:
            enabled(node, axis);
            break;
        case ODS_PHASE_SLOWING:
            if (axis->velocity != 0) {
                return;
            }
            axis->flags &= ~ODS_AXIS_RELEASED;
            begin(node, axis, ODS_PHASE_APPLYING, has_brake ? values->brake_delay_times_apply : 0u);
            break;
        case ODS_PHASE_APPLYING:
            held(node, axis);
            break;
        default:
            return;
        }
    }
}

/* Transition 4: power up. */
static void power_on(ods_node_t *node, ods_axis_t *axis)
{
    ods_motor_power_on(axis);
    if ((axis->values->encoder_init_position & FROM_ENCODER) != 0u) {
        ods_motion_start_from_encoder(axis);
    }
    begin(node, axis, ODS_PHASE_POWERING, axis->values->enable_drive_delay_time);
    proceed(node, axis);
}

/* Power down, as soon as the axis is at rest. */
static void slow_down(ods_node_t *node, ods_axis_t *axis, ods_stop_t stop)
{
    axis->stop = (uint8_t)stop;
    begin(node, axis, ODS_PHASE_SLOWING, 0);
    proceed(node, axis);
}

static void stop_quickly(ods_node_t *node, ods_axis_t *axis)
{
    enter(node, axis, ODS_PDS_STATE_QUICK_STOP_ACTIVE);
    axis->quick_stop = axis->values->quick_stop_option_code;
    const int is_on_mode_ramp = (axis->quick_stop == OFF_ON_MODE_RAMP) || (axis->quick_stop == STAY_ON_MODE_RAMP);
    const ods_stop_t stop = is_on_mode_ramp ? ODS_STOP_MODE_RAMP : ODS_STOP_QUICK_STOP_RAMP;
    if (is_staying(axis)) {
        axis->stop = (uint8_t)stop;
    } else {
        slow_down(node, axis, stop);
    }
}

/* ---- the controlword --------------------------------------------------------------------------------------------- */

static void obey(ods_node_t *node, ods_axis_t *axis, uint8_t command)
{
    const uint8_t end = end_of(node, axis, command);
    if (end == ODS_NONE) {
        return;
    }
    if (command == (uint8_t)ODS_PDS_COMMAND_FAULT_RESET) {
        if (ods_emcy_has_fault_cause(node, axis->conditions)) {
            return;
        }
        ods_emcy_raise(node, ODS_CONDITION_FAULT_RESET, axis->number);
    }
    if (end == (uint8_t)ODS_PDS_STATE_OPERATION_ENABLED) {
        if (axis->state == (uint8_t)ODS_PDS_STATE_SWITCHED_ON) {
            power_on(node, axis);
        } else if (is_staying(axis)) {
            enabled(node, axis);
        }
    } else if (end == (uint8_t)ODS_PDS_STATE_QUICK_STOP_ACTIVE) {
        stop_quickly(node, axis);
    } else if (
        (end == (uint8_t)ODS_PDS_STATE_SWITCHED_ON) && (axis->state == (uint8_t)ODS_PDS_STATE_OPERATION_ENABLED)) {
        axis->goal = end;
        slow_down(node, axis, ODS_STOP_MODE_RAMP);
    } else {
        power_off(axis);
        enter(node, axis, end);
    }
}

/* All commands that the word gives, in the order of the table: 3 and 4 may follow each other in one turn. */
static void decode(ods_node_t *node, ods_axis_t *axis, uint16_t word, uint16_t before)
{
    const uint32_t risen = (uint32_t)word & ~(uint32_t)before;
    axis->flags |= ODS_AXIS_DEAF; /* unless state or phase change */
    for (uint32_t n = 0; n < node->device->pds_command_count; n++) {
        const ods_pds_command_row_t *const row = &node->device->pds_commands[n];
        if (((word & row->mask) == row->value) && ((risen & row->edge) == row->edge)) {
            obey(node, axis, row->command);
        }
    }
    ods_mode_control(axis, word, before);
}

/* ---- events ------------------------------------------------------------------------------------------------------ */

void ods_fsa_reset(const ods_node_t *node, ods_axis_t *axis)
{
    enter(node, axis, ODS_PDS_STATE_SWITCH_ON_DISABLED);
    axis->goal = ODS_NONE;
}

int ods_fsa_command(ods_node_t *node, ods_axis_t *axis, uint16_t word)
{
    const uint16_t before = axis->word;
    const int is_commanded = (axis->state == (uint8_t)ODS_PDS_STATE_SWITCHED_ON) ||
                             (axis->state == (uint8_t)ODS_PDS_STATE_OPERATION_ENABLED);
    if ((word == before) && ((axis->flags & ODS_AXIS_DEAF) != 0u)) {
        return 0;
    }
    axis->word = word;
    if (is_commanded && (axis->phase != (uint8_t)ODS_PHASE_NONE)) {
        axis->before = before;
        axis->flags |= ODS_AXIS_WAITING;
    } else {
        decode(node, axis, word, before);
    }
    return 1;
}

void ods_fsa_fault(ods_node_t *node, ods_axis_t *axis, int off)
{
    const int is_reacting = axis->state == (uint8_t)ODS_PDS_STATE_FAULT_REACTION_ACTIVE;
    if (is_reacting ? !off : !follow(node, axis, ODS_PDS_EVENT_FAULT)) {
        return;
    }
    axis->flags &= ~ODS_AXIS_WAITING;
    if (off || ((axis->flags & ODS_AXIS_POWERED) == 0u)) {
        power_off(axis);
        (void)follow(node, axis, ODS_PDS_EVENT_FAULT_REACTION_DONE);
    } else {
        slow_down(node, axis, ODS_STOP_QUICK_STOP_RAMP);
    }
}

void ods_fsa_network_stopped(ods_node_t *node, ods_axis_t *axis)
{
    /* One that is powering up would be enabled when no command reaches it any more. */
    const int is_powering_up =
        (axis->phase == (uint8_t)ODS_PHASE_POWERING) || (axis->phase == (uint8_t)ODS_PHASE_RELEASING);
    if ((axis->state == (uint8_t)ODS_PDS_STATE_OPERATION_ENABLED) || is_powering_up) {
        ods_fsa_fault(node, axis, 0);
    }
}

void ods_fsa_tick(ods_node_t *node, ods_axis_t *axis)
{
    if ((axis->delay != 0u) && (axis->begun != node->now)) {
        axis->delay--;
    }
    proceed(node, axis);
    if ((axis->phase == (uint8_t)ODS_PHASE_NONE) && ((axis->flags & ODS_AXIS_WAITING) != 0u)) {
        /* A transition is complete: the word that waited for it is decoded. */
        axis->flags &= ~ODS_AXIS_WAITING;
        decode(node, axis, axis->word, axis->before);
    }
}
