#include "ods/node.h"

#include <string.h>

#include "ods_access.h"
#include "ods_axis.h"
#include "ods_can.h"
#include "ods_core.h"
#include "ods_emcy.h"
#include "ods_heartbeat.h"
#include "ods_io.h"
#include "ods_led.h"
#include "ods_nmt.h"
#include "ods_od.h"
#include "ods_pdo.h"
#include "ods_sdo.h"
#include "ods_sync.h"

/* Nothing is put off further than this, so that two instants can always be compared. */
#define HORIZON_US 0x40000000u

/* ---- the order of things ----------------------------------------------------------------------------------------- */

static void tick(ods_node_t *node)
{
    ods_timer_stop(node, ODS_TIMER_TICK);
    ods_io_tick(node);
    ods_axis_tick_all(node);
}

/* Everything that is due at this instant. */
static void work_off(ods_node_t *node)
{
    ods_sdo_time_out(node);
    ods_heartbeat_expire(node);
    if (ods_timer_due(node, ODS_TIMER_TICK)) {
        tick(node);
    }
    (void)ods_next_tick(node);
    if (ods_timer_due(node, ODS_TIMER_HEARTBEAT)) {
        node->deadlines[ODS_TIMER_HEARTBEAT] += node->common->producer_heartbeat_time * ODS_US_PER_MS;
        node->work |= ODS_WORK_HEARTBEAT;
    }
    if (ods_timer_due(node, ODS_TIMER_EMCY)) {
        ods_timer_stop(node, ODS_TIMER_EMCY);
        node->work |= ODS_WORK_EMCY;
    }
    if (ods_led_is_due(node)) {
        node->work |= ODS_WORK_OUTPUT;
    }
    ods_pdo_expire(node);
}

/* The end of a turn: what has piled up leaves, each kind at its place. */
ODS_RARE static void finish(ods_node_t *node)
{
    if ((node->work & ODS_WORK_EMCY) != 0u) {
        ods_emcy_transmit(node);
    }
    if ((node->work & ODS_WORK_ERROR_BEHAVIOUR) != 0u) {
        ods_nmt_follow_error(node);
    }
    if ((node->work & ODS_WORK_HEARTBEAT) != 0u) {
        ods_heartbeat_transmit(node);
    }
    if ((node->work & ODS_WORK_TPDO) != 0u) {
        ods_pdo_transmit(node);
    }
    if ((node->work & ODS_WORK_OUTPUT) != 0u) {
        ods_led_put(node, 0);
        ods_io_put(node, 0);
        ods_axis_put_all(node);
    }
    node->work = 0;
}

/* ---- time -------------------------------------------------------------------------------------------------------- */

/* The next instant at which something is due, or the horizon. */
static uint32_t earliest(const ods_node_t *node, uint32_t horizon)
{
    uint32_t at = horizon;
    for (uint32_t armed = node->armed; armed != 0u; armed &= armed - 1u) {
        const uint32_t deadline = node->deadlines[ods_lowest_bit(armed)];
        at = ods_before(deadline, at) ? deadline : at;
    }
    return ods_pdo_earliest(node, at);
}

/* Work off all instants up to `now`. */
static void catch_up(ods_node_t *node, uint32_t now)
{
    while (!ods_before(now, node->wake)) {
        /* The grid of ticks must not fall behind, however little happens: work_off() moves it on. */
        node->wake = earliest(node, node->deadlines[ODS_TIMER_TICK] + HORIZON_US);
        if (ods_before(now, node->wake)) {
            break;
        }
        node->now = node->wake;
        work_off(node);
        finish(node);
    }
    node->now = now;
}

void ods_node_advance(ods_node_t *node, uint32_t now)
{
    catch_up(node, now);
}

int ods_node_next(const ods_node_t *node, uint32_t *at)
{
    const uint32_t horizon = node->now + HORIZON_US;
    const uint32_t next = earliest(node, horizon);
    if (next == horizon) {
        return 0;
    }
    *at = next;
    return 1;
}

/* ---- events ------------------------------------------------------------------------------------------------------ */

static void end_turn(ods_node_t *node)
{
    if (node->work != 0u) {
        finish(node);
    }
}

static void dispatch(ods_node_t *node, const ods_frame_t *frame)
{
    const uint32_t id = frame->id;
    if (id == ODS_CAN_ID_SDO_REQUEST + node->id) {
        if (((node->services & ODS_SERVICE_SDO) != 0u) && (frame->remote == 0u)) {
            ods_sdo_receive(node, frame);
        }
    } else if (id == ODS_CAN_ID_NMT) {
        ods_nmt_receive(node, frame);
    } else if (id >= ODS_CAN_ID_ERROR_CONTROL) {
        ods_heartbeat_receive(node, frame);
    } else if (((node->services & ODS_SERVICE_PDO) != 0u) && (frame->remote == 0u)) {
        if (ods_sync_is(node, id)) {
            ods_pdo_sync(node);
        }
        ods_pdo_receive(node, frame);
    } /* no PDO answers a remote frame */
}

void ods_node_receive(ods_node_t *node, uint32_t now, const ods_frame_t *frame)
{
    if (ods_before(now, node->wake)) {
        node->now = now;
    } else {
        catch_up(node, now);
    }
    if (node->can != (uint8_t)ODS_CAN_BUS_OFF) {
        dispatch(node, frame);
    }
    if (node->work != 0u) {
        finish(node);
    }
}

/* Before power-on what comes in is only noted. */
static int is_on(const ods_node_t *node)
{
    return node->id != 0u;
}

void ods_node_input(ods_node_t *node, uint32_t now, ods_input_t input, uint8_t channel, uint32_t value)
{
    if (!is_on(node)) {
        ods_io_set(node, input, channel, value);
        return;
    }
    catch_up(node, now);
    ods_io_set(node, input, channel, value);
    if (input != ODS_INPUT_ADDRESS) {
        ods_tick_arm(node);
    }
}

void ods_node_fault(ods_node_t *node, uint32_t now, uint8_t axis, ods_condition_t condition, int holds)
{
    const uint32_t bit = 1u << condition;
    if ((axis >= node->device->axes) || (condition >= ODS_AXIS_CONDITIONS) ||
        (condition == ODS_CONDITION_FAULT_RESET)) {
        return;
    }
    if (is_on(node)) {
        catch_up(node, now);
        ods_tick_arm(node);
    }
    ods_axis_wake(&node->axes[axis]);
    node->axes[axis].faults = holds ? (node->axes[axis].faults | bit) : (node->axes[axis].faults & ~bit);
}

void ods_node_motor(ods_node_t *node, uint32_t now, uint8_t axis, const ods_motor_answer_t *answer)
{
    if (axis >= node->device->axes) {
        return;
    }
    if (is_on(node)) {
        catch_up(node, now);
        ods_tick_arm(node);
    }
    ods_axis_wake(&node->axes[axis]);
    node->axes[axis].answer = *answer;
    end_turn(node);
}

void ods_node_can(ods_node_t *node, uint32_t now, ods_can_t event)
{
    catch_up(node, now);
    ods_can_report(node, event);
    end_turn(node);
}

uint32_t ods_node_read(
    const ods_node_t *node, uint16_t index, uint8_t sub, uint8_t *octets, uint16_t size, uint16_t *length)
{
    ods_od_ref_t ref = { NULL, 0 };
    uint8_t number[8];
    uint32_t abort = ods_od_find(node->od, index, sub, &ref);
    if (abort == 0u) {
        abort = ods_access_readable(node, &ref);
    }
    if (abort != 0u) {
        return abort;
    }
    const uint8_t *const from = ods_od_octets(node->od, node->values, &ref, number, length);
    if (*length > size) {
        return ODS_ABORT_OUT_OF_MEMORY;
    }
    memcpy(octets, from, *length);
    return 0;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

void ods_node_init(
    ods_node_t *node,
    const ods_device_t *device,
    const ods_memory_t *memory,
    const ods_port_t *port,
    const ods_config_t *config)
{
    memset(node, 0, sizeof *node);
    node->device = device;
    node->od = device->od;
    node->port = port;
    node->values = (uint8_t *)memory->values;
    node->common = (ods_device_values_t *)ods_od_instance(device->od, memory->values, ODS_DEVICE_INSTANCE);
    node->axes = memory->axes;
    node->buffer = memory->buffer;
    node->config = *config;
    node->pdo.rpdos = memory->rpdos;
    node->pdo.tpdos = memory->tpdos;
    node->pdo.mapped = memory->mapped;
    node->io.enable = 1;
    for (uint8_t axis = 0; axis < device->axes; axis++) {
        ods_axis_init(node, axis);
    }
    ods_emcy_init(node);
}

void ods_node_power_on(ods_node_t *node, uint32_t now)
{
    node->now = now;
    node->wake = now + HORIZON_US;
    node->armed = 0;
    node->deadlines[ODS_TIMER_TICK] = now + ODS_TICK_US;
    node->changed = 0;
    node->state = ODS_NMT_STATE_INITIALISING;
    node->services = 0;
    node->can = ODS_CAN_OK;
    for (uint32_t led = 0; led < (uint32_t)ODS_LEDS; led++) {
        node->leds[led].row = ODS_NONE;
    }
    for (uint32_t axis = 0; axis < node->device->axes; axis++) {
        node->axes[axis].outputs = 0;
    }
    ods_nmt_reset_node(node);
    node->work &= (uint8_t)~ODS_WORK_OUTPUT;
    finish(node);
    ods_led_put(node, 1);
    ods_io_put(node, 1);
    ods_axis_put_all(node);
}
