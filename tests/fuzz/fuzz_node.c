/*
 * A libFuzzer target: octets become events, two nodes of different devices get them, and what always holds of a node
 * is checked after each.
 *
 * The first octets are the bench: where time begins and which nodes there are, what the ports lack, the address
 * switches of each node. Then follow events. The first octet of an event says to which node it goes (bit 7) and what
 * happens (low bits); those that follow are its details. Details lead to things that exist more often than chance
 * would: to entries of the dictionary, to their limits, to CAN-IDs that the node listens to. Every other frame can be
 * made, too.
 */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "invariants.h"
#include "rig.h"
#include "tmcm3230.h"
#include "tmcm6212.h"

#define NODES 2u
#define VALUES_EVERY 16u /* events between two walks through the values */
#define WAKE_UPS 200u /* due instants that one event may visit, so that an input cannot run for hours */

typedef struct {
    const uint8_t *octets;
    size_t left;
} input_t;

static rig_t rigs[NODES];

/* Those of an input: both, or one alone, which takes half the time. */
static uint32_t first_node;
static uint32_t end_node;

/* ---- details ----------------------------------------------------------------------------------------------------- */

static uint8_t take(input_t *input)
{
    if (input->left == 0u) {
        return 0;
    }
    input->left--;
    return *input->octets++;
}

static uint32_t take16(input_t *input)
{
    const uint32_t low = take(input);
    return low | ((uint32_t)take(input) << 8);
}

static uint32_t take32(input_t *input)
{
    const uint32_t low = take16(input);
    return low | (take16(input) << 16);
}

static const rig_entry_t *take_entry(const rig_t *rig, input_t *input)
{
    return &rig->entries[take16(input) % rig->entry_count];
}

static uint32_t octets_of(const ods_od_entry_t *entry)
{
    const uint32_t type = entry->kind & ODS_TYPE_MASK;
    return (type < ODS_U8) ? 0u : (1u << (type & 3u));
}

/* A limit of an entry, or the value beside it. */
static uint32_t limit_of(const ods_od_t *od, const ods_od_entry_t *entry, uint8_t choice)
{
    const ods_od_rule_t *const rule = &od->rules[entry->rule];
    uint32_t value = 0;
    if ((entry->rule != 0u) && (rule->intervals > 0u)) {
        const ods_od_interval_t *const interval = &od->intervals[rule->first + ((choice >> 2) % rule->intervals)];
        value = (choice & 1u) ? interval->high : interval->low;
        value += (choice & 2u) ? ((choice & 1u) ? 1u : 0xFFFFFFFFu) : 0u;
    }
    return ODS_OD_IS_SIGNED(entry->kind) ? (uint32_t)ODS_OD_BIAS(value) : value;
}

/* A value that might mean something to an entry. */
static uint32_t take_value(const rig_t *rig, input_t *input, const ods_od_entry_t *entry)
{
    const uint8_t choice = take(input);
    switch (choice & 7u) {
    case 0:
    case 1:
        return limit_of(rig->device->od, entry, (uint8_t)(choice >> 3));
    case 2: /* what a mapping entry names */
    {
        const rig_entry_t *const mapped = take_entry(rig, input);
        return ((uint32_t)mapped->index << 16) | ((uint32_t)mapped->sub << 8) | (8u * octets_of(mapped->ref.entry));
    }
    case 3: /* a COB-ID */
        return ((uint32_t)(choice & 0x18u) << 27) | (take16(input) & 0x7FFu);
    case 4: /* a watched heartbeat: few nodes, short times */
        return ((uint32_t)(choice >> 5) << 16) | take(input);
    case 5:
    case 6:
        return take(input);
    default:
        return take32(input);
    }
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

static void put32(uint8_t *octets, uint32_t value)
{
    for (uint32_t n = 0; n < 4u; n++) {
        octets[n] = (uint8_t)(value >> (8u * n));
    }
}

static void put_address(ods_frame_t *frame, uint16_t index, uint8_t sub)
{
    frame->data[1] = (uint8_t)index;
    frame->data[2] = (uint8_t)(index >> 8);
    frame->data[3] = sub;
}

/* A request of an SDO client (CiA 301, 7.2.4.3). */
static void make_sdo(const rig_t *rig, input_t *input, ods_frame_t *frame)
{
    const uint8_t choice = take(input);
    const rig_entry_t *entry;
    frame->id = (uint16_t)(0x600u + rig->node->id);
    frame->length = 8;
    switch (choice & 7u) {
    case 0: /* upload */
        entry = take_entry(rig, input);
        frame->data[0] = 0x40;
        put_address(frame, entry->index, entry->sub);
        break;
    case 1: /* expedited download */
    case 2:
        entry = take_entry(rig, input);
        frame->data[0] = (uint8_t)(0x23u | (((4u - octets_of(entry->ref.entry)) & 3u) << 2));
        put_address(frame, entry->index, entry->sub);
        put32(&frame->data[4], take_value(rig, input, entry->ref.entry));
        break;
    case 3: /* segmented download: with or without its size, which may be wrong */
        entry = take_entry(rig, input);
        frame->data[0] = (choice & 8u) ? 0x21u : 0x20u;
        put_address(frame, entry->index, entry->sub);
        put32(&frame->data[4], (choice & 16u) ? take(input) : octets_of(entry->ref.entry));
        break;
    case 4: /* its segments: right toggle, or any */
        frame->data[0] = (choice & 8u) ? (uint8_t)(take(input) & 0x1Fu)
                                       : (uint8_t)((rig->node->sdo.toggle ? 0x10u : 0u) | ((choice >> 4) & 0x0Fu));
        put32(&frame->data[1], take32(input));
        frame->data[5] = frame->data[6] = frame->data[7] = take(input);
        break;
    case 5: /* segments of an upload */
        frame->data[0] = (choice & 8u) ? 0x70u : (uint8_t)(0x60u | (rig->node->sdo.toggle ? 0x10u : 0u));
        break;
    case 6: /* any request */
        for (uint32_t n = 0; n < 8u; n++) {
            frame->data[n] = take(input);
        }
        break;
    default: /* too short */
        frame->length = (choice >> 3) & 7u;
        frame->data[0] = take(input);
        break;
    }
}

static void make_nmt(const rig_t *rig, input_t *input, ods_frame_t *frame)
{
    const ods_device_t *const device = rig->device;
    const uint8_t choice = take(input);
    const uint8_t command = device->nmt_commands[(choice & 15u) % device->nmt_command_count].command;
    frame->length = (choice & 0x40u) ? (uint8_t)(take(input) % 9u) : 2u;
    frame->data[0] = (choice & 0x80u) ? take(input) : command;
    frame->data[1] = (choice & 0x20u) ? take(input) : ((choice & 0x10u) ? rig->node->id : 0u);
}

static void make_pdo(const rig_t *rig, input_t *input, ods_frame_t *frame)
{
    const ods_od_t *const od = rig->device->od;
    const uint32_t first = od->scope_instances[ODS_SCOPE_RPDO];
    const uint32_t count = od->scope_instances[ODS_SCOPE_RPDO + 1] - first;
    const uint8_t choice = take(input);
    const uint32_t number = choice % count;
    const ods_pdo_values_t *const pdo = ods_od_instance(od, rig->memory.values, (uint16_t)(first + number));
    frame->id = (uint16_t)(pdo->pdo_cob_id & 0x7FFu);
    frame->length = (choice & 0x80u) ? (uint8_t)(take(input) % 9u) : rig->node->pdo.rpdos[number].pdo.length;
    for (uint32_t n = 0; n < frame->length; n++) {
        frame->data[n] = take(input);
    }
}

static void make_error_control(const rig_t *rig, input_t *input, ods_frame_t *frame)
{
    const uint8_t choice = take(input);
    if (choice & 0x80u) { /* guarding asks */
        frame->id = (uint16_t)(0x700u + rig->node->id);
        frame->remote = (choice & 0x40u) == 0u;
    } else { /* another node lives */
        frame->id = (uint16_t)(0x700u + (choice & 7u));
        frame->data[0] = (choice & 0x40u) ? 5u : ((choice & 0x20u) ? 0u : 127u);
    }
    frame->length = 1;
}

static void make_any(input_t *input, ods_frame_t *frame)
{
    const uint8_t choice = take(input);
    frame->id = (uint16_t)(take16(input) & 0x7FFu);
    frame->length = (uint8_t)((choice & 15u) % 9u);
    frame->remote = choice >> 7;
    for (uint32_t n = 0; (n < frame->length) && !frame->remote; n++) {
        frame->data[n] = take(input);
    }
}

/* ---- events ------------------------------------------------------------------------------------------------------ */

/* What an upload says is what a read without a bus says. */
static void check_upload(const rig_t *rig, const ods_frame_t *request)
{
    const uint8_t *const data = rig->answer.data;
    const uint16_t index = (uint16_t)(request->data[1] | (request->data[2] << 8));
    uint8_t octets[4] = { 0, 0, 0, 0 };
    uint16_t length = 0;
    if ((request->data[0] >> 5) == 2u && (data[0] & 0xE3u) == 0x43u) {
        PROMISE(ods_node_read(rig->node, index, request->data[3], octets, 4, &length) == 0u);
        PROMISE(length == 4u - ((data[0] >> 2) & 3u));
        PROMISE(memcmp(octets, &data[4], 4) == 0);
        PROMISE(memcmp(&data[1], &request->data[1], 3) == 0);
    }
}

/* The SDO server gives one answer to each request that it may hear, and none to a client that gives up. */
static void receive(rig_t *rig, uint32_t now, const ods_frame_t *frame)
{
    const ods_node_t *const node = rig->node;
    const int hears = (node->state != (uint8_t)ODS_NMT_STATE_STOPPED) && (node->can != (uint8_t)ODS_CAN_BUS_OFF) &&
                      (frame->id == 0x600u + node->id) && (frame->length == 8u) && (frame->remote == 0u);
    const uint32_t expected = (hears && ((frame->data[0] >> 5) != 4u)) ? 1u : 0u;
    ods_node_receive(rig->node, now, frame);
    if (!rig->dead) {
        PROMISE(rig->answers == expected);
        if (expected == 1u) {
            check_upload(rig, frame);
        }
    }
}

/* A segmented download as a client would do it, but of any number of octets, and at times with a wrong toggle bit. */
static void download(rig_t *rig, uint32_t now, input_t *input)
{
    const rig_entry_t *const entry = take_entry(rig, input);
    const uint8_t choice = take(input);
    const uint32_t segments = choice & 7u;
    ods_frame_t frame = { (uint16_t)(0x600u + rig->node->id), 8, 0, { 0x20 } };
    put_address(&frame, entry->index, entry->sub);
    receive(rig, now, &frame);
    for (uint32_t n = 1; n <= segments; n++) {
        const uint32_t unused = take(input);
        const uint32_t last = (n == segments) ? (choice >> 7) : 0u;
        frame.data[0] = (uint8_t)(((unused & 7u) << 1) | ((n & 1u) ? 0u : 0x10u) | last);
        frame.data[0] ^= (unused == 0x77u) ? 0x10u : 0u;
        put32(&frame.data[1], take32(input));
        rig_turn(rig);
        receive(rig, now, &frame);
    }
}

/* A node that is not due has nothing to do. */
static void check_idle(rig_t *rig, uint32_t now)
{
    uint32_t at = 0;
    if (!ods_node_next(rig->node, &at) || ((int32_t)(at - now) > 0)) {
        rig_turn(rig);
        ods_node_advance(rig->node, now);
        PROMISE((rig->frames == 0u) && (rig->changes == 0u));
    }
}

/* Time passes for both nodes: in one step if it is short, else from one due instant to the next. Returns the end. */
static uint32_t pass(uint32_t now, uint32_t step)
{
    uint32_t wake_ups = 0;
    uint32_t end = now + step;
    if (step > 20000u) {
        while (wake_ups < WAKE_UPS) {
            uint32_t next = end;
            for (uint32_t n = first_node; n < end_node; n++) {
                uint32_t at = 0;
                if (ods_node_next(rigs[n].node, &at) && ((int32_t)(at - next) < 0)) {
                    next = at;
                }
            }
            if (next == end) {
                break;
            }
            for (uint32_t n = first_node; n < end_node; n++) {
                rig_turn(&rigs[n]);
                ods_node_advance(rigs[n].node, next);
                invariants_check(&rigs[n], next);
            }
            now = next;
            wake_ups++;
        }
        if (wake_ups == WAKE_UPS) {
            end = now;
        }
    }
    for (uint32_t n = first_node; n < end_node; n++) {
        rig_turn(&rigs[n]);
        ods_node_advance(rigs[n].node, end);
    }
    return end;
}

static uint32_t take_step(input_t *input)
{
    const uint8_t choice = take(input);
    switch (choice & 3u) {
    case 0:
        return 1000u * (choice >> 2);
    case 1:
        return 100000u * (choice >> 2);
    case 2:
        return take16(input);
    default:
        return take32(input) & 0x3FFFFFFFu;
    }
}

static void read_entry(const rig_t *rig, input_t *input)
{
    const uint8_t choice = take(input);
    const uint16_t size = take(input) & 0x3Fu;
    const rig_entry_t *const entry = take_entry(rig, input);
    uint8_t *const octets = malloc((size == 0u) ? 1u : size);
    uint16_t length = 0;
    if (octets == NULL) {
        exit(2);
    }
    const uint16_t index = (choice & 1u) ? (uint16_t)take16(input) : entry->index;
    if (ods_node_read(rig->node, index, entry->sub, octets, size, &length) == 0u) {
        PROMISE(length <= size);
    }
    free(octets);
}

static void change_memory(rig_t *rig, input_t *input)
{
    const uint8_t choice = take(input);
    rig->nvm_fails = choice & 1u;
    rig->os_status = (uint8_t)(choice >> 1);
    if (choice & 8u) { /* power will be lost at a later write */
        rig->writes_left = take16(input);
    }
    if (choice & 16u) { /* octets turn into others */
        rig->nvm[take16(input) % rig->nvm_size] = take(input);
    }
    if (choice & 32u) {
        for (uint32_t n = 0; n < rig->nvm_size; n++) {
            rig->nvm[n] = take(input);
        }
    }
}

/* Switches, load, encoder and faults of an axis. */
static void change_hardware(rig_t *rig, uint32_t now, input_t *input)
{
    const uint8_t choice = take(input);
    const uint8_t axis = (uint8_t)((choice & 7u) % rig->device->axes);
    ods_motor_answer_t answer = rig->motors[axis];
    answer.lines = take(input);
    if (choice & 8u) {
        answer.load = (uint16_t)(4u * take(input));
    }
    if (choice & 16u) {
        answer.faults = take32(input) & ((1u << ODS_CONDITIONS) - 1u);
    }
    if (choice & 32u) { /* somebody turns the shaft */
        answer.encoder = (int32_t)take32(input);
    }
    rig_motor(rig, now, axis, &answer);
}

static void happen(rig_t *rig, input_t *input, uint32_t *now, uint8_t what)
{
    ods_frame_t frame = { 0, 0, 0, { 0 } };
    ods_condition_t condition;
    uint8_t detail;
    switch (what & 15u) {
    case 0:
    case 1:
    case 2:
    case 3:
        make_sdo(rig, input, &frame);
        receive(rig, *now, &frame);
        break;
    case 4:
        download(rig, *now, input);
        break;
    case 5:
        make_nmt(rig, input, &frame);
        receive(rig, *now, &frame);
        break;
    case 6:
        make_pdo(rig, input, &frame);
        receive(rig, *now, &frame);
        break;
    case 7:
        frame.id = (uint16_t)(rig->node->common->cob_id_sync & 0x7FFu);
        frame.length = (uint8_t)((what >> 4) & 7u);
        receive(rig, *now, &frame);
        break;
    case 8:
        make_error_control(rig, input, &frame);
        receive(rig, *now, &frame);
        break;
    case 9:
        make_any(input, &frame);
        receive(rig, *now, &frame);
        break;
    case 10:
    case 11:
        *now = pass(*now, take_step(input));
        break;
    case 12:
        detail = take(input);
        ods_node_input(rig->node, *now, (ods_input_t)((detail & 7u) % ODS_INPUTS), detail >> 3, take32(input));
        break;
    case 13:
        detail = take(input);
        if (detail & 8u) {
            change_memory(rig, input);
        } else {
            ods_node_can(rig->node, *now, (ods_can_t)(detail & 7u));
        }
        break;
    case 14:
        detail = take(input);
        if (detail & 0x20u) {
            change_hardware(rig, *now, input);
            break;
        }
        condition = (ods_condition_t)(take(input) % (ODS_CONDITIONS + 1u));
        ods_node_fault(rig->node, *now, detail & 15u, condition, (detail & 16u) != 0u);
        break;
    default:
        if (what & 0x10u) {
            rig_power_on(rig, *now, take(input));
        } else {
            read_entry(rig, input);
        }
        break;
    }
}

/* ---- the target -------------------------------------------------------------------------------------------------- */

static void check_values(void)
{
    for (uint32_t n = first_node; n < end_node; n++) {
        invariants_check_values(&rigs[n]);
    }
}

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *octets, size_t size);

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    rig_make(&rigs[0], &tmcm6212_device);
    rig_make(&rigs[1], &tmcm3230_device);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *octets, size_t size)
{
    input_t input = { octets, size };
    const uint8_t begin = take(&input);
    const uint8_t lacks = take(&input);
    uint32_t now = (begin & 1u) ? 0xFFFFFF00u : 0u;
    uint32_t events = 0;

    first_node = ((begin & 0x0Cu) == 0x08u) ? 1u : 0u;
    end_node = ((begin & 0x0Cu) == 0x04u) ? 1u : NODES;
    for (uint32_t n = first_node; n < end_node; n++) {
        rig_renew(&rigs[n], (begin & 2u) ? lacks : 0u);
        rig_power_on(&rigs[n], now, take(&input));
        invariants_check(&rigs[n], now);
    }
    while (input.left > 0u) {
        const uint8_t what = take(&input);
        for (uint32_t n = first_node; n < end_node; n++) {
            rig_turn(&rigs[n]);
        }
        happen(&rigs[first_node + ((what >> 7) % (end_node - first_node))], &input, &now, what);
        for (uint32_t n = first_node; n < end_node; n++) {
            if (rigs[n].dead) {
                rig_power_on(&rigs[n], now, 0);
            }
            invariants_check(&rigs[n], now);
            check_idle(&rigs[n], now);
        }
        if (++events % VALUES_EVERY == 0u) {
            check_values();
        }
    }
    check_values();
    return 0;
}
