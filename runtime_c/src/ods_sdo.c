#include "ods_sdo.h"

#include <string.h>

#include "ods_access.h"
#include "ods_core.h"
#include "ods_od.h"

/* Command specifiers, the upper three bits of the first octet (CiA 301, 7.2.4.3). */
enum {
    CLIENT_DOWNLOAD_SEGMENT = 0,
    CLIENT_DOWNLOAD = 1,
    CLIENT_UPLOAD = 2,
    CLIENT_UPLOAD_SEGMENT = 3,
    CLIENT_ABORT = 4
};

#define SERVER_DOWNLOAD 0x60u
#define SERVER_DOWNLOAD_SEGMENT 0x20u
#define SERVER_UPLOAD 0x40u
#define SERVER_UPLOAD_SEGMENT 0x00u
#define ABORT_TRANSFER 0x80u

#define SIZED 0x01u /* of an initiate: the size is told */
#define EXPEDITED 0x02u /* of an initiate: the data is in this frame */
#define TOGGLE 0x10u /* of a segment */
#define LAST 0x01u /* of a segment: no more follow */

#define SEGMENT 7u /* octets of data in a segment */
#define TIME_OUT_US 1000000u

enum {
    IDLE,
    UPLOAD,
    DOWNLOAD
};

/* An entry and how it is called on the bus. */
typedef struct {
    ods_od_ref_t ref;
    uint16_t index;
    uint8_t sub;
} target_t;

static uint32_t address_of(const target_t *target)
{
    return target->index | (uint32_t)target->sub << 16;
}

void ods_sdo_abandon(ods_node_t *node)
{
    node->sdo.phase = IDLE;
    ods_timer_stop(node, ODS_TIMER_SDO);
}

static void answer(const ods_node_t *node, ods_frame_t *frame)
{
    frame->id = (uint16_t)(ODS_CAN_ID_SDO_ANSWER + node->id);
    frame->length = 8;
    frame->remote = 0;
    ods_send(node, frame);
}

/* An answer to an initiate, with 4 octets of data. */
static void answer_initiate(const ods_node_t *node, uint32_t command, const target_t *target, uint32_t data)
{
    ods_frame_t frame;
    frame.data[0] = (uint8_t)command;
    frame.data[1] = (uint8_t)target->index;
    frame.data[2] = (uint8_t)(target->index >> 8);
    frame.data[3] = target->sub;
    ods_put_32(&frame.data[4], data);
    answer(node, &frame);
}

/* Refuse a request. Whatever transfer goes on ends with it. */
static void abort_with(ods_node_t *node, const target_t *target, uint32_t code)
{
    ods_sdo_abandon(node);
    answer_initiate(node, ABORT_TRANSFER, target, code);
}

/* Abort the transfer that goes on; without one, the address in the frame is that of the last one. */
static void abort_transfer(ods_node_t *node, uint32_t code)
{
    const target_t target = { node->sdo.ref, node->sdo.index, node->sdo.sub };
    abort_with(node, &target, code);
}

static void begin(ods_node_t *node, const target_t *target, uint8_t phase, uint16_t length)
{
    ods_sdo_t *const sdo = &node->sdo;
    sdo->ref = target->ref;
    sdo->index = target->index;
    sdo->sub = target->sub;
    sdo->phase = phase;
    sdo->toggle = 0;
    sdo->done = 0;
    sdo->length = length;
    ods_timer_start(node, ODS_TIMER_SDO, node->now + TIME_OUT_US);
}

/* ---- upload ------------------------------------------------------------------------------------------------------ */

/*
 * An upload is a snapshot: what may change is copied before the first segment leaves. Up to 4 octets need none, they
 * leave at once.
 */
static void upload_octets(ods_node_t *node, const target_t *target)
{
    uint8_t number[8];
    uint16_t length;
    const uint8_t *octets = ods_od_octets(node->od, node->values, &target->ref, number, &length);

    if ((length <= 4u) && (length > 0u)) {
        uint32_t data = 0;
        for (uint32_t n = 0; n < length; n++) {
            data |= (uint32_t)octets[n] << (8u * n);
        }
        answer_initiate(node, SERVER_UPLOAD | EXPEDITED | SIZED | (4u - length) << 2, target, data);
        return;
    }
    if (length <= node->od->buffer_size) {
        memcpy(node->buffer, octets, length);
        octets = node->buffer;
    } /* else it is a constant */
    begin(node, target, UPLOAD, length);
    node->sdo.source = octets;
    answer_initiate(node, SERVER_UPLOAD | SIZED, target, length);
}

static void upload(ods_node_t *node, const target_t *target)
{
    const uint32_t abort = ods_access_readable(node, &target->ref);
    if (abort != 0u) {
        abort_with(node, target, abort);
    } else {
        upload_octets(node, target);
    }
}

static void upload_segment(ods_node_t *node)
{
    ods_sdo_t *const sdo = &node->sdo;
    const uint32_t left = (uint32_t)sdo->length - sdo->done;
    const uint32_t count = (left < SEGMENT) ? left : SEGMENT;
    ods_frame_t frame = { 0 };

    frame.data[0] = (uint8_t)(SERVER_UPLOAD_SEGMENT | sdo->toggle | (SEGMENT - count) << 1);
    memcpy(&frame.data[1], sdo->source + sdo->done, count);
    if (count == left) {
        frame.data[0] |= LAST;
        ods_sdo_abandon(node);
    } else {
        sdo->done = (uint16_t)(sdo->done + count);
        sdo->toggle ^= TOGGLE;
        ods_timer_start(node, ODS_TIMER_SDO, node->now + TIME_OUT_US);
    }
    answer(node, &frame);
}

/* ---- download ---------------------------------------------------------------------------------------------------- */

static void download_expedited(ods_node_t *node, const target_t *target, const ods_frame_t *frame)
{
    const ods_od_entry_t *const entry = target->ref.entry;
    const uint32_t command = frame->data[0];
    /* Without a size the type says how much of the frame is meant. */
    const uint32_t room = ods_od_room(node->od, entry);
    const uint32_t length = ((command & SIZED) != 0u) ? 4u - ((command >> 2) & 3u) : ((room < 4u) ? room : 4u);
    node->sdo.address = address_of(target);
    uint32_t abort = (length == room) ? 0u : ods_access_length(node, entry, length);

    if (abort == 0u) {
        abort = ods_access_write(node, &target->ref, &frame->data[4], (uint16_t)length);
    }
    if (abort == 0u) {
        answer_initiate(node, SERVER_DOWNLOAD, target, 0);
    } else {
        abort_with(node, target, abort);
    }
}

static void download(ods_node_t *node, const target_t *target, const ods_frame_t *frame)
{
    const ods_od_entry_t *const entry = target->ref.entry;
    if (entry->rule == 0u) {
        abort_with(node, target, ODS_ABORT_READ_ONLY);
    } else if ((frame->data[0] & EXPEDITED) != 0u) {
        download_expedited(node, target, frame);
    } else {
        uint32_t length = ods_od_room(node->od, entry);
        uint32_t abort = 0;
        if ((frame->data[0] & SIZED) != 0u) {
            length = ods_get_32(&frame->data[4]);
            abort = ods_access_length(node, entry, length);
        }
        if (abort != 0u) {
            abort_with(node, target, abort);
        } else {
            begin(node, target, DOWNLOAD, (uint16_t)length);
            node->sdo.sized = frame->data[0] & SIZED;
            answer_initiate(node, SERVER_DOWNLOAD, target, 0);
        }
    }
}

/* The last segment is in: the value is complete. */
static uint32_t finish_download(ods_node_t *node, uint32_t length)
{
    const target_t target = { node->sdo.ref, node->sdo.index, node->sdo.sub };
    uint32_t abort = ods_access_length(node, target.ref.entry, length);
    if ((node->sdo.sized != 0u) && (length != node->sdo.length)) {
        abort = ODS_ABORT_TOO_SHORT;
    }
    node->sdo.address = address_of(&target);
    return (abort != 0u) ? abort : ods_access_write(node, &target.ref, node->buffer, (uint16_t)length);
}

static void download_segment(ods_node_t *node, const ods_frame_t *frame)
{
    ods_sdo_t *const sdo = &node->sdo;
    const uint32_t count = SEGMENT - ((frame->data[0] >> 1) & 7u);
    const uint32_t length = sdo->done + count;
    const uint32_t toggle = sdo->toggle;

    if (length > sdo->length) {
        abort_transfer(node, ODS_ABORT_TOO_LONG);
        return;
    }
    memcpy(node->buffer + sdo->done, &frame->data[1], count);
    sdo->done = (uint16_t)length;
    sdo->toggle ^= TOGGLE;
    if ((frame->data[0] & LAST) == 0u) {
        ods_timer_start(node, ODS_TIMER_SDO, node->now + TIME_OUT_US);
    } else {
        const uint32_t abort = finish_download(node, length);
        if (abort != 0u) {
            abort_transfer(node, abort);
            return;
        }
        ods_sdo_abandon(node);
    }
    ods_frame_t reply = { 0 };
    reply.data[0] = (uint8_t)(SERVER_DOWNLOAD_SEGMENT | toggle);
    answer(node, &reply);
}

/* ---- the server -------------------------------------------------------------------------------------------------- */

static void segment(ods_node_t *node, const ods_frame_t *frame, uint8_t phase)
{
    if (node->sdo.phase != phase) {
        abort_transfer(node, ODS_ABORT_COMMAND);
    } else if ((frame->data[0] & TOGGLE) != node->sdo.toggle) {
        abort_transfer(node, ODS_ABORT_TOGGLE_BIT);
    } else if (phase == (uint8_t)UPLOAD) {
        upload_segment(node);
    } else {
        download_segment(node, frame);
    }
}

/* Any request, in any phase. */
ODS_RARE static void serve(ods_node_t *node, const ods_frame_t *frame)
{
    const uint32_t specifier = (uint32_t)frame->data[0] >> 5;
    if ((specifier == CLIENT_UPLOAD) || (specifier == CLIENT_DOWNLOAD)) {
        target_t target;
        target.index = (uint16_t)ods_get_16(&frame->data[1]);
        target.sub = frame->data[3];
        if (node->sdo.phase != (uint8_t)IDLE) {
            ods_sdo_abandon(node);
        }
        const uint32_t abort = ods_od_find(node->od, target.index, target.sub, &target.ref);
        if (abort != 0u) {
            abort_with(node, &target, abort);
        } else if (specifier == CLIENT_UPLOAD) {
            upload(node, &target);
        } else {
            download(node, &target, frame);
        }
    } else if (specifier == CLIENT_UPLOAD_SEGMENT) {
        segment(node, frame, UPLOAD);
    } else if (specifier == CLIENT_DOWNLOAD_SEGMENT) {
        segment(node, frame, DOWNLOAD);
    } else if (specifier == CLIENT_ABORT) {
        ods_sdo_abandon(node);
    } else {
        const target_t target = { { NULL, 0 }, (uint16_t)ods_get_16(&frame->data[1]), frame->data[3] };
        abort_with(node, &target, ODS_ABORT_COMMAND);
    }
}

/*
 * Nearly every request is an expedited one for a number of up to 4 octets. Its answer is the request with another
 * command and other data, so the way is short. What is not that simple, serve() answers.
 */
static void echo(const ods_node_t *node, const ods_frame_t *request, uint32_t command, uint32_t data)
{
    ods_frame_t frame = *request;
    frame.id = (uint16_t)(ODS_CAN_ID_SDO_ANSWER + node->id);
    frame.data[0] = (uint8_t)command;
    ods_put_32(&frame.data[4], data);
    ods_send(node, &frame);
}

/* The command of an expedited download of a number, by the logarithm of its size; 8 octets have none. */
static uint32_t download_command(uint32_t kind)
{
    return (0x00232B2Fu >> (8u * (kind & 3u))) & 0xFFu;
}

#define UPLOAD_COMMAND ((uint32_t)CLIENT_UPLOAD << 5)
/* From the command of a client's download to that of a server's upload. */
#define DOWNLOAD_TO_UPLOAD (SERVER_UPLOAD - ((uint32_t)CLIENT_DOWNLOAD << 5))

ODS_RARE static void download_number(
    ods_node_t *node, const ods_frame_t *frame, const ods_od_entry_t *entry, uint32_t instance)
{
    node->sdo.address = ods_get_32(&frame->data[0]) >> 8;
    const uint32_t abort = ods_access_write_number(node, entry, instance, ods_get_32(&frame->data[4]));
    echo(node, frame, (abort == 0u) ? SERVER_DOWNLOAD : ABORT_TRANSFER, abort);
}

void ods_sdo_receive(ods_node_t *node, const ods_frame_t *frame)
{
    ods_od_ref_t ref;
    if (frame->length != 8u) {
        return;
    }
    if ((node->sdo.phase == (uint8_t)IDLE) &&
        (ods_od_locate(node->od, ods_get_16(&frame->data[1]), frame->data[3], &ref) == 0u) &&
        ods_od_is_short(ref.entry->kind)) {
        const uint32_t command = frame->data[0];
        const uint32_t expected = download_command(ref.entry->kind);
        if (command == UPLOAD_COMMAND) {
            if (((ref.entry->kind & ODS_READ) != 0u) && (node->common->tmcl_mode == 0u)) {
                echo(node, frame, expected + DOWNLOAD_TO_UPLOAD, ods_od_number(node->od, node->values, &ref));
                return;
            }
        } else if ((command == expected) && (ref.entry->rule != 0u)) {
            download_number(node, frame, ref.entry, ref.instance);
            return;
        }
    }
    serve(node, frame);
}

void ods_sdo_time_out(ods_node_t *node)
{
    if (ods_timer_due(node, ODS_TIMER_SDO)) {
        abort_transfer(node, ODS_ABORT_TIMEOUT);
    }
}
