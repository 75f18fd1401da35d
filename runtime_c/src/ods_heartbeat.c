#include "ods_heartbeat.h"

#include "ods_core.h"
#include "ods_emcy.h"

#define TOGGLE 0x80u
#define STATE_MASK 0x7Fu
#define LIFE_STEP 1000000u /* ticks that a timer may last */
#define GUARDING 0x80u /* in `lost`: the master is missing */
#define TIMERS (((1u << ODS_CONSUMERS) - 1u) << ODS_TIMER_CONSUMER_1 | 1u << ODS_TIMER_LIFE) /* bits of those here */

ODS_STATIC_ASSERT(
    every_consumer_has_a_timer,
    sizeof((ods_device_values_t *)0)->consumer_heartbeat_time / sizeof(uint32_t) == ODS_CONSUMERS);

/* ---- what is missing --------------------------------------------------------------------------------------------- */

static void set_lost(ods_node_t *node, uint32_t lost)
{
    node->heartbeat.lost = (uint8_t)lost;
    ods_emcy_set(node, ODS_CONDITION_HEARTBEAT_LOST, lost != 0u);
}

static void found(ods_node_t *node, uint32_t what)
{
    if ((node->heartbeat.lost & what) != 0u) {
        set_lost(node, node->heartbeat.lost & ~what);
    }
}

/* ---- consumer ---------------------------------------------------------------------------------------------------- */

/* The node that an entry of 1016h watches; 0 if it watches none. */
static uint32_t watched(uint32_t entry)
{
    const uint32_t id = (entry >> 16) & 0xFFu;
    return (((entry & 0xFFFFu) != 0u) && (id <= ODS_NODE_IDS)) ? id : 0u;
}

uint32_t ods_heartbeat_check_consumer(const ods_node_t *node, uint32_t sub, uint32_t value)
{
    const uint32_t id = watched(value);
    for (uint32_t n = 0; n < ODS_CONSUMERS; n++) {
        if ((id != 0u) && (n + 1u != sub) && (watched(node->common->consumer_heartbeat_time[n]) == id)) {
            return ODS_ABORT_PARAMETER_INCOMPATIBLE;
        }
    }
    return 0;
}

void ods_heartbeat_consumer_written(ods_node_t *node, uint32_t sub)
{
    ods_timer_stop(node, ODS_TIMER_CONSUMER_1 + sub - 1u);
    found(node, 1u << (sub - 1u));
}

static void consume(ods_node_t *node, uint32_t id, uint32_t state)
{
    for (uint32_t n = 0; n < ODS_CONSUMERS; n++) {
        const uint32_t entry = node->common->consumer_heartbeat_time[n];
        if (watched(entry) != id) {
            continue;
        }
        if (state == (uint32_t)ODS_NMT_STATE_INITIALISING) {
            ods_timer_stop(node, ODS_TIMER_CONSUMER_1 + n);
        } else {
            ods_timer_start(node, ODS_TIMER_CONSUMER_1 + n, node->now + ((entry & 0xFFFFu) * ODS_US_PER_MS));
            found(node, 1u << n);
        }
    }
}

/* ---- guarding ---------------------------------------------------------------------------------------------------- */

/* Let the timer run for as many of the remaining ticks as it may. */
static void run_life_timer(ods_node_t *node, uint32_t from)
{
    const uint32_t left = node->heartbeat.life_ticks;
    const uint32_t ticks = (left < LIFE_STEP) ? left : LIFE_STEP;
    node->heartbeat.life_ticks = left - ticks;
    ods_timer_start(node, ODS_TIMER_LIFE, from + (ticks * ODS_TICK_US));
}

/* Life time is over at the first tick that is not before its end. */
static void start_life_time(ods_node_t *node)
{
    const uint32_t time = (uint32_t)node->common->guard_time * node->common->life_time_factor;
    const uint32_t tick = ods_next_tick(node);
    if (time != 0u) {
        node->heartbeat.life_ticks = (tick - node->now == ODS_TICK_US) ? time - 1u : time;
        run_life_timer(node, tick);
    }
}

static void stop_life_time(ods_node_t *node)
{
    ods_timer_stop(node, ODS_TIMER_LIFE);
    found(node, GUARDING);
}

static void answer_guarding(ods_node_t *node)
{
    ods_frame_t frame = { 0 };
    if (node->common->producer_heartbeat_time != 0u) {
        return;
    }
    frame.id = (uint16_t)(ODS_CAN_ID_ERROR_CONTROL + node->id);
    frame.length = 1;
    frame.data[0] = (uint8_t)(node->state | node->heartbeat.toggle);
    node->heartbeat.toggle ^= TOGGLE;
    ods_send(node, &frame);
    start_life_time(node);
    found(node, GUARDING);
}

void ods_heartbeat_guard_written(ods_node_t *node)
{
    stop_life_time(node);
}

/* ---- time -------------------------------------------------------------------------------------------------------- */

void ods_heartbeat_expire(ods_node_t *node)
{
    if ((node->armed & TIMERS) == 0u) {
        return;
    }
    for (uint32_t n = 0; n < ODS_CONSUMERS; n++) {
        if (ods_timer_due(node, ODS_TIMER_CONSUMER_1 + n)) {
            ods_timer_stop(node, ODS_TIMER_CONSUMER_1 + n);
            set_lost(node, node->heartbeat.lost | 1u << n);
        }
    }
    if (!ods_timer_due(node, ODS_TIMER_LIFE)) {
        return;
    }
    if (node->heartbeat.life_ticks != 0u) {
        run_life_timer(node, node->now);
    } else {
        ods_timer_stop(node, ODS_TIMER_LIFE);
        set_lost(node, node->heartbeat.lost | GUARDING);
    }
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

void ods_heartbeat_receive(ods_node_t *node, const ods_frame_t *frame)
{
    const uint32_t id = frame->id - ODS_CAN_ID_ERROR_CONTROL;
    if (frame->remote != 0u) {
        if (id == node->id) {
            answer_guarding(node);
        }
    } else if ((frame->length == 1u) && (id != 0u)) {
        consume(node, id, frame->data[0] & STATE_MASK);
    }
}

/* ---- producer ---------------------------------------------------------------------------------------------------- */

static void send_state(const ods_node_t *node, uint8_t state)
{
    ods_frame_t frame = { 0 };
    frame.id = (uint16_t)(ODS_CAN_ID_ERROR_CONTROL + node->id);
    frame.length = 1;
    frame.data[0] = state;
    ods_send(node, &frame);
}

void ods_heartbeat_producer_written(ods_node_t *node)
{
    const uint32_t period = node->common->producer_heartbeat_time;
    if (period == 0u) {
        ods_timer_stop(node, ODS_TIMER_HEARTBEAT);
    } else {
        stop_life_time(node); /* heartbeat and guarding exclude each other */
        ods_timer_start(node, ODS_TIMER_HEARTBEAT, node->now + (period * ODS_US_PER_MS));
    }
}

void ods_heartbeat_transmit(const ods_node_t *node)
{
    send_state(node, node->state);
}

void ods_heartbeat_boot_up(const ods_node_t *node)
{
    send_state(node, ODS_NMT_STATE_INITIALISING);
}

void ods_heartbeat_reset(ods_node_t *node)
{
    for (uint32_t n = 0; n < ODS_CONSUMERS; n++) {
        ods_timer_stop(node, ODS_TIMER_CONSUMER_1 + n);
    }
    ods_timer_stop(node, ODS_TIMER_LIFE);
    node->heartbeat.toggle = 0;
    set_lost(node, 0);
    ods_heartbeat_producer_written(node);
}
