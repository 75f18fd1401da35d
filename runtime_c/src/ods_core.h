/*
 * What all modules of a node share: time, timers, frames, and the marks for the end of the turn.
 */
#ifndef ODS_CORE_H
#define ODS_CORE_H

#include <string.h>

#include "ods/node.h"

/* A function that is seldom needed, kept out of those that often run: there its registers and its stack would cost. */
#if defined(__GNUC__)
#define ODS_RARE __attribute__((noinline))
#else
#define ODS_RARE
#endif

#define ODS_TICK_US 1000u
#define ODS_US_PER_MS 1000u
#define ODS_US_PER_100US 100u

/* Function codes of the pre-defined connection set, to which the node-ID is added (CiA 301, 7.3.3). */
#define ODS_CAN_ID_NMT 0x000u
#define ODS_CAN_ID_SDO_ANSWER 0x580u
#define ODS_CAN_ID_SDO_REQUEST 0x600u
#define ODS_CAN_ID_ERROR_CONTROL 0x700u
#define ODS_CAN_ID_MASK 0x7FFu
#define ODS_NODE_IDS 127u

/* Bits of a COB-ID (CiA 301, 7.5.2.5, 7.5.2.17, 7.5.2.35). */
#define ODS_COB_ID_INVALID 0x80000000u
#define ODS_COB_ID_NO_REMOTE 0x40000000u /* of a PDO */
#define ODS_COB_ID_GENERATE 0x40000000u /* of SYNC */
#define ODS_COB_ID_RESERVED 0x3FFFF800u /* 29 bit CAN-IDs, which no node here has */

/* The number of the lowest bit that is set; there has to be one. */
static inline uint32_t ods_lowest_bit(uint32_t bits)
{
#if defined(__GNUC__) && (__SIZEOF_INT__ == 4)
    return (uint32_t)__builtin_ctz(bits);
#else
    uint32_t number = 0;
    while (((bits >> number) & 1u) == 0u) {
        number++;
    }
    return number;
#endif
}

/* ---- octets on the bus: little-endian ---------------------------------------------------------------------------- */

#if defined(__BYTE_ORDER__) && (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)

/* So are those in memory. A copy of constant length is one instruction wherever a pointer may be odd. */
static inline uint32_t ods_get_16(const uint8_t *octets)
{
    uint16_t value;
    memcpy(&value, octets, sizeof value);
    return value;
}

static inline uint32_t ods_get_32(const uint8_t *octets)
{
    uint32_t value;
    memcpy(&value, octets, sizeof value);
    return value;
}

static inline void ods_put_16(uint8_t *octets, uint32_t value)
{
    const uint16_t low = (uint16_t)value;
    memcpy(octets, &low, sizeof low);
}

static inline void ods_put_32(uint8_t *octets, uint32_t value)
{
    memcpy(octets, &value, sizeof value);
}

#else

static inline uint32_t ods_get_16(const uint8_t *octets)
{
    return octets[0] | (uint32_t)octets[1] << 8;
}

static inline uint32_t ods_get_32(const uint8_t *octets)
{
    return octets[0] | (uint32_t)octets[1] << 8 | (uint32_t)octets[2] << 16 | (uint32_t)octets[3] << 24;
}

static inline void ods_put_16(uint8_t *octets, uint32_t value)
{
    octets[0] = (uint8_t)value;
    octets[1] = (uint8_t)(value >> 8);
}

static inline void ods_put_32(uint8_t *octets, uint32_t value)
{
    ods_put_16(octets, value);
    ods_put_16(octets + 2, value >> 16);
}

#endif

/* ---- time -------------------------------------------------------------------------------------------------------- */

/* Whether instant `a` lies before `b`. They are less than 2^31 us apart. */
static inline int ods_before(uint32_t a, uint32_t b)
{
    return (int32_t)(a - b) < 0;
}

static inline void ods_wake_by(ods_node_t *node, uint32_t at)
{
    if (ods_before(at, node->wake)) {
        node->wake = at;
    }
}

static inline void ods_timer_start(ods_node_t *node, uint32_t timer, uint32_t at)
{
    node->deadlines[timer] = at;
    node->armed |= 1u << timer;
    ods_wake_by(node, at);
}

static inline void ods_timer_stop(ods_node_t *node, uint32_t timer)
{
    node->armed &= ~(1u << timer);
}

static inline int ods_timer_armed(const ods_node_t *node, uint32_t timer)
{
    return (node->armed & (1u << timer)) != 0u;
}

/* Whether a timer has run out. It stays armed until it is stopped or started again. */
static inline int ods_timer_due(const ods_node_t *node, uint32_t timer)
{
    return ods_timer_armed(node, timer) && !ods_before(node->now, node->deadlines[timer]);
}

/* The next tick. Those that were not armed have gone by unseen, but the grid holds. */
static inline uint32_t ods_next_tick(ods_node_t *node)
{
    uint32_t *const at = &node->deadlines[ODS_TIMER_TICK];
    if (!ods_before(node->now, *at)) {
        *at += ((node->now - *at) / ODS_TICK_US + 1u) * ODS_TICK_US;
    }
    return *at;
}

/* Have the next tick visited. */
static inline void ods_tick_arm(ods_node_t *node)
{
    ods_timer_start(node, ODS_TIMER_TICK, ods_next_tick(node));
}

/* ---- frames and values ------------------------------------------------------------------------------------------- */

/* Send a frame. In bus-off it is lost. */
static inline void ods_send(const ods_node_t *node, const ods_frame_t *frame)
{
    if (node->can != (uint8_t)ODS_CAN_BUS_OFF) {
        node->port->send(node->port->context, frame);
    }
}

#define ODS_DEVICE_INSTANCE 0u

static inline uint32_t ods_axis_instance(const ods_node_t *node, uint32_t axis)
{
    return node->od->scope_instances[ODS_SCOPE_AXIS] + axis;
}

static inline int ods_is_axis_instance(const ods_node_t *node, uint32_t instance)
{
    return (instance >= node->od->scope_instances[ODS_SCOPE_AXIS]) &&
           (instance < node->od->scope_instances[ODS_SCOPE_RPDO]);
}

/*
 * How ods_node_t.changed and ods_tpdo_t.watched name values: the lower half has a bit for an instance whose values the
 * node itself changed, the upper half one for an entry that was written. What shares a bit only costs a look in vain.
 */
static inline uint32_t ods_instance_bit(uint32_t instance)
{
    return 1u << (instance & 15u);
}

static inline uint32_t ods_entry_bit(const ods_od_entry_t *entry)
{
    return 0x10000u << ((entry->at >> 2) & 15u);
}

static inline void ods_mark_changed(ods_node_t *node, uint32_t bit)
{
    if ((node->pdo.watched & bit) != 0u) {
        node->changed |= bit;
        node->work |= ODS_WORK_TPDO;
    }
}

/* The node itself changed a value that a TPDO may carry. */
static inline void ods_value_changed(ods_node_t *node, uint32_t instance)
{
    ods_mark_changed(node, ods_instance_bit(instance));
}

static inline ods_axis_values_t *ods_axis_values(const ods_node_t *node, uint32_t axis)
{
    return (ods_axis_values_t *)ods_od_instance(node->od, node->values, ods_axis_instance(node, axis));
}

#endif
