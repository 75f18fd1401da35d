#include "cases.h"

#include <string.h>

#include "ods/node.h"
#include DEVICE_HEADER

#define MOST 4096u /* entries that a device may have here */
#define FAILED 0xFFFFFFFFu /* frames expected of a case that could not be set up */

/* The order of requests is random but the same everywhere (Numerical Recipes' generator). */
static uint32_t random_state = 6212u;

static uint32_t random_below(uint32_t limit)
{
    random_state = (random_state * 1664525u) + 1013904223u;
    return (random_state >> 8) % limit;
}

static DEVICE device;
static uint32_t now;
static ods_frame_t last; /* sent last */
static uint32_t sent;
static uint32_t sent_before; /* when the case began */
static uint32_t expected; /* frames that the case should have sent */

static ods_frame_t requests[MOST];
static uint32_t request_count;

typedef struct {
    uint16_t index;
    uint8_t sub;
} address_t;

static address_t addresses[MOST];
static uint32_t address_count;

/* ---- the port ---------------------------------------------------------------------------------------------------- */

static void on_send(void *context, const ods_frame_t *frame)
{
    (void)context;
    last = *frame;
    sent++;
}

static const ods_port_t port = { .send = on_send };

/* ---- functions that are called through a pointer ---------------------------------------------------------------- */

static void receive_nothing(ods_node_t *node, uint32_t at, const ods_frame_t *frame)
{
    (void)node;
    (void)at;
    (void)frame;
}

static void receive_and_send(ods_node_t *node, uint32_t at, const ods_frame_t *frame)
{
    (void)at;
    node->port->send(node->port->context, frame);
}

static uint32_t find_nothing(const ods_od_t *od, uint16_t index, uint8_t sub, ods_od_ref_t *ref)
{
    (void)od;
    (void)index;
    (void)sub;
    (void)ref;
    return 0;
}

static uint32_t find(const ods_od_t *od, uint16_t index, uint8_t sub, ods_od_ref_t *ref)
{
    return ods_od_find(od, index, sub, ref);
}

static void (*volatile receive)(ods_node_t *node, uint32_t at, const ods_frame_t *frame);
static uint32_t (*volatile look_up)(const ods_od_t *od, uint16_t index, uint8_t sub, ods_od_ref_t *ref);
static void (*volatile advance)(ods_node_t *node, uint32_t at) = ods_node_advance;

/* ---- requests ---------------------------------------------------------------------------------------------------- */

static void find_addresses(void)
{
    for (uint32_t address = 0; address <= 0xFFFFFFu; address++) {
        ods_od_ref_t ref;
        const uint32_t code = ods_od_find(device.node.od, (uint16_t)(address >> 8), (uint8_t)address, &ref);
        if (code == (uint32_t)ODS_ABORT_NO_OBJECT) {
            address |= 0xFFu;
        }
        if ((code == 0u) && (address_count < MOST)) {
            addresses[address_count].index = (uint16_t)(address >> 8);
            addresses[address_count].sub = (uint8_t)address;
            address_count++;
        }
    }
    for (uint32_t n = address_count; n > 1u; n--) {
        const uint32_t other = random_below(n);
        const address_t address = addresses[other];
        addresses[other] = addresses[n - 1u];
        addresses[n - 1u] = address;
    }
}

static void make_frame(ods_frame_t *frame, uint32_t id, uint32_t length, const uint8_t *octets)
{
    memset(frame, 0, sizeof *frame);
    frame->id = (uint16_t)id;
    frame->length = (uint8_t)length;
    memcpy(frame->data, octets, length);
}

static void make_request(ods_frame_t *frame, uint8_t command, const address_t *address, const uint8_t *octets)
{
    const uint8_t data[8] = { command,
                              (uint8_t)address->index,
                              (uint8_t)(address->index >> 8),
                              address->sub,
                              octets[0],
                              octets[1],
                              octets[2],
                              octets[3] };
    make_frame(frame, 0x600u + device.node.id, 8, data);
}

static const uint8_t nothing[4] = { 0, 0, 0, 0 };

static int answered(const ods_frame_t *request, uint8_t answer)
{
    ods_node_receive(&device.node, now, request);
    return (last.data[0] & 0xE3u) == answer;
}

/* Every entry that is read by an expedited upload. */
static uint32_t prepare_uploads(void)
{
    request_count = 0;
    for (uint32_t n = 0; n < address_count; n++) {
        make_request(&requests[request_count], 0x40, &addresses[n], nothing);
        if (answered(&requests[request_count], 0x43)) {
            request_count++;
        }
    }
    expected = 1;
    receive = ods_node_receive;
    return request_count;
}

/* Every entry that takes the value which it has by an expedited download. */
static uint32_t prepare_downloads(void)
{
    request_count = 0;
    for (uint32_t n = 0; n < address_count; n++) {
        ods_frame_t *const request = &requests[request_count];
        make_request(request, 0x40, &addresses[n], nothing);
        if (answered(request, 0x43)) {
            const uint8_t size = (uint8_t)(last.data[0] & 0x0Cu);
            make_request(request, (uint8_t)(0x23u | size), &addresses[n], &last.data[4]);
            if (answered(request, 0x60)) {
                request_count++;
            }
        }
    }
    expected = 1;
    receive = ods_node_receive;
    return request_count;
}

static void operate_request(uint32_t number)
{
    receive(&device.node, now, &requests[number]);
}

static uint32_t prepare_call(void)
{
    const uint32_t count = prepare_uploads();
    receive = receive_nothing;
    expected = 0;
    return count;
}

static uint32_t prepare_call_and_send(void)
{
    const uint32_t count = prepare_uploads();
    receive = receive_and_send;
    return count;
}

/* ---- look-ups ---------------------------------------------------------------------------------------------------- */

static volatile uint32_t found;

static void operate_find(uint32_t number)
{
    ods_od_ref_t ref;
    found = look_up(device.node.od, addresses[number].index, addresses[number].sub, &ref);
}

static uint32_t prepare_find(void)
{
    look_up = find;
    expected = 0;
    return address_count;
}

static uint32_t prepare_find_nothing(void)
{
    look_up = find_nothing;
    expected = 0;
    return address_count;
}

/* ---- PDOs -------------------------------------------------------------------------------------------------------- */

static void download(uint16_t index, uint8_t sub, uint32_t value, uint32_t size)
{
    const address_t address = { index, sub };
    const uint8_t octets[4] = {
        (uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16), (uint8_t)(value >> 24)
    };
    ods_frame_t request;
    make_request(&request, (uint8_t)(0x23u | ((4u - size) << 2)), &address, octets);
    if (!answered(&request, 0x60)) {
        expected = FAILED;
    }
}

/* Map an entry of 16 bits and one of 32 into the first PDO of a direction, as CiA 301 says (7.5.2.38). */
static void map(uint16_t communication, uint32_t can_id, uint32_t first, uint32_t second, uint8_t type)
{
    const uint16_t mapping = (uint16_t)(communication + 0x200u);
    download(communication, 1, 0xC0000000u | can_id, 4);
    download(mapping, 0, 0, 1);
    download(mapping, 1, first, 4);
    download(mapping, 2, second, 4);
    download(mapping, 0, 2, 1);
    download(communication, 2, type, 1);
    download(communication, 1, 0x40000000u | can_id, 4);
}

static void command(uint8_t code)
{
    const uint8_t octets[2] = { code, 0 };
    ods_frame_t frame;
    make_frame(&frame, 0, 2, octets);
    ods_node_receive(&device.node, now, &frame);
}

static void start(void)
{
    command(ODS_NMT_COMMAND_START);
    now += 1000000u;
    ods_node_advance(&device.node, now);
}

#define PDO_FRAMES 1000u

/* Control word and target position: the position another one in each frame, the word the same. */
static uint32_t prepare_rpdo(void)
{
    expected = 0;
    map(0x1400, 0x200u + device.node.id, 0x60400010u, 0x607A0020u, 0xFF);
    for (uint32_t n = 0; n < PDO_FRAMES; n++) {
        const uint8_t data[6] = { 0, 0, (uint8_t)random_below(256), (uint8_t)n, 0, 0 };
        make_frame(&requests[n], 0x200u + device.node.id, 6, data);
    }
    start();
    receive = ods_node_receive;
    return PDO_FRAMES;
}

/* Status word and actual position, sent at each SYNC; the other TPDOs rest. */
static uint32_t prepare_tpdo(void)
{
    expected = 1;
    for (uint16_t n = 1; n < 4u; n++) {
        download((uint16_t)(0x1800u + n), 1, 0xC0000000u, 4);
    }
    map(0x1800, 0x180u + device.node.id, 0x60410010u, 0x60640020u, 1);
    for (uint32_t n = 0; n < PDO_FRAMES; n++) {
        make_frame(&requests[n], 0x80, 0, nothing);
    }
    start();
    receive = ods_node_receive;
    return PDO_FRAMES;
}

/* ---- time -------------------------------------------------------------------------------------------------------- */

static uint32_t prepare_tick(void)
{
    expected = 0;
    start();
    return 1000;
}

static void operate_tick(uint32_t number)
{
    (void)number;
    now += 1000u;
    advance(&device.node, now);
}

static void pass_nothing(ods_node_t *node, uint32_t at)
{
    (void)node;
    (void)at;
}

static uint32_t prepare_no_tick(void)
{
    const uint32_t count = prepare_tick();
    advance = pass_nothing;
    return count;
}

/* ---- motion ------------------------------------------------------------------------------------------------------ */

/* A six point move that takes longer than the case, with all its parameters. */
static void set_out(uint16_t axis)
{
    const uint16_t motor = (uint16_t)(0x2000u + axis * 0x200u);
    const uint16_t profile = (uint16_t)(0x6000u + axis * 0x800u);
    download((uint16_t)(motor + 0x05u), 0, 3, 4); /* no limit switches */
    download((uint16_t)(motor + 0x10u), 0, 1000, 4);
    download((uint16_t)(motor + 0x11u), 0, 20000, 4);
    download((uint16_t)(motor + 0x12u), 0, 10000, 4);
    download((uint16_t)(motor + 0x13u), 0, 20000, 4);
    download((uint16_t)(profile + 0x81u), 0, 51200, 4);
    download((uint16_t)(profile + 0x82u), 0, 1000, 4);
    download((uint16_t)(profile + 0x83u), 0, 51200, 4);
    download((uint16_t)(profile + 0x84u), 0, 51200, 4);
    download((uint16_t)(profile + 0x60u), 0, ODS_MODE_PROFILE_POSITION, 1);
    operate_tick(0);
    download((uint16_t)(profile + 0x7Au), 0, 0x7FFFFFFFu, 4);
    download((uint16_t)(profile + 0x40u), 0, 0x06, 2);
    download((uint16_t)(profile + 0x40u), 0, 0x0F, 2);
    download((uint16_t)(profile + 0x40u), 0, 0x0F, 2);
    download((uint16_t)(profile + 0x40u), 0, 0x1F, 2);
}

/* All axes speed up and cruise; nothing is sent. */
static uint32_t prepare_motion(void)
{
    advance = ods_node_advance;
    expected = 0;
    command(ODS_NMT_COMMAND_ENTER_PRE_OPERATIONAL);
    for (uint16_t axis = 0; axis < device.node.device->axes; axis++) {
        set_out(axis);
    }
    operate_tick(0);
    for (uint16_t axis = 0; axis < device.node.device->axes; axis++) {
        const address_t statusword = { (uint16_t)(0x6041u + axis * 0x800u), 0 };
        ods_frame_t request;
        make_request(&request, 0x40, &statusword, nothing);
        if (!answered(&request, 0x4B & 0xE3) || ((last.data[5] & 0x40u) == 0u)) {
            expected = FAILED; /* bit 14: it moves */
        }
    }
    return 2000;
}

/* ---- the cases --------------------------------------------------------------------------------------------------- */

const bench_case_t bench_cases[] = {
    { "call", prepare_call, operate_request },
    { "call_and_send", prepare_call_and_send, operate_request },
    { "upload", prepare_uploads, operate_request },
    { "download", prepare_downloads, operate_request },
    { "find_nothing", prepare_find_nothing, operate_find },
    { "find", prepare_find, operate_find },
    { "rpdo", prepare_rpdo, operate_request },
    { "tpdo", prepare_tpdo, operate_request },
    { "tick", prepare_tick, operate_tick },
    { "no_tick", prepare_no_tick, operate_tick },
    { "motion", prepare_motion, operate_tick }, /* behind it no case finds the node at rest */
};

const uint32_t bench_case_count = sizeof bench_cases / sizeof bench_cases[0];

void bench_begin(void)
{
    static const ods_config_t config = { 1, 1 };
    INIT(&device, &port, &config);
    ods_node_power_on(&device.node, now);
    find_addresses();
}

uint32_t bench_prepare(const bench_case_t *item)
{
    const uint32_t count = item->prepare();
    sent_before = sent;
    return count;
}

int bench_worked(uint32_t operations)
{
    return (expected != FAILED) && (sent - sent_before == operations * expected);
}
