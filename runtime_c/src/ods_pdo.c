#include "ods_pdo.h"

#include <string.h>

#include "ods_core.h"
#include "ods_emcy.h"
#include "ods_od.h"

#define MAX_BITS 64u
#define SYNCHRONOUS_LAST 240u /* transmission types 1 to 240 */

/* Sub-indices of a communication parameter record. */
enum {
    SUB_TRANSMISSION_TYPE = 2,
    SUB_INHIBIT_TIME = 3,
    SUB_EVENT_TIMER = 5
};

/* ods_tpdo_t.flags */
#define DUE 0x01u /* has to be sent, changed or not */
#define PENDING 0x02u /* waits for the end of its inhibit time */
#define SENT 0x04u /* `sent_at` is that of a transmission not long ago */
#define TIMED 0x08u /* its event timer runs */

/* A transmission that is longer ago no longer inhibits, and its instant would soon be ambiguous. */
#define LONG_AGO_US 0x10000000u

/* ---- from a PDO to its parts ------------------------------------------------------------------------------------- */

static ods_pdo_values_t *values_of(const ods_node_t *node, uint32_t instance)
{
    return (ods_pdo_values_t *)ods_od_instance(node->od, node->values, (uint16_t)instance);
}

static ods_pdo_values_t *rpdo_values(const ods_node_t *node, uint32_t number)
{
    return values_of(node, node->od->scope_instances[ODS_SCOPE_RPDO] + number);
}

static ods_pdo_values_t *tpdo_values(const ods_node_t *node, uint32_t number)
{
    return values_of(node, node->od->scope_instances[ODS_SCOPE_TPDO] + number);
}

static uint32_t rpdo_count(const ods_node_t *node)
{
    return (uint32_t)node->od->scope_instances[ODS_SCOPE_TPDO] - node->od->scope_instances[ODS_SCOPE_RPDO];
}

static uint32_t tpdo_count(const ods_node_t *node)
{
    return (uint32_t)node->od->scope_instances[ODS_SCOPES] - node->od->scope_instances[ODS_SCOPE_TPDO];
}

static int is_tpdo(const ods_node_t *node, uint32_t instance)
{
    return instance >= node->od->scope_instances[ODS_SCOPE_TPDO];
}

/* Resolved entries of a PDO. */
static ods_pdo_ref_t *refs_of(const ods_node_t *node, uint32_t instance)
{
    return &node->pdo.mapped[(instance - node->od->scope_instances[ODS_SCOPE_RPDO]) * node->od->max_mapped];
}

static int is_active(const ods_pdo_values_t *pdo)
{
    return (pdo->pdo_cob_id & ODS_COB_ID_INVALID) == 0u;
}

static int is_synchronous(const ods_pdo_values_t *pdo)
{
    return (pdo->pdo_transmission_type >= 1u) && (pdo->pdo_transmission_type <= SYNCHRONOUS_LAST);
}

static int is_operational(const ods_node_t *node)
{
    return (node->services & ODS_SERVICE_PDO) != 0u;
}

/* Bits of a number in a PDO: a BOOLEAN takes one. */
static uint32_t bits_of(uint32_t kind)
{
    return ((kind & ODS_TYPE_MASK) == ODS_BOOL) ? 1u : 8u * ods_od_number_size(kind);
}

static uint32_t octets_of(uint32_t bits)
{
    return (bits + 7u) / 8u;
}

/* ---- parameters -------------------------------------------------------------------------------------------------- */

static uint32_t check_inactive(const ods_node_t *node, const ods_target_t *target)
{
    if (node->common->manufacturer_mode != 0u) {
        return 0;
    }
    return is_active(values_of(node, target->ref.instance)) ? ODS_ABORT_DEVICE_STATE : 0u;
}

uint32_t ods_pdo_count_state(const ods_node_t *node, const ods_target_t *target)
{
    return check_inactive(node, target);
}

uint32_t ods_pdo_mapping_state(const ods_node_t *node, const ods_target_t *target)
{
    if ((node->common->manufacturer_mode == 0u) && (values_of(node, target->ref.instance)->pdo_mapped_count != 0u)) {
        return ODS_ABORT_DEVICE_STATE;
    }
    return check_inactive(node, target);
}

uint32_t ods_pdo_check_cob_id(const ods_node_t *node, const ods_target_t *target, uint32_t cob_id)
{
    const ods_pdo_values_t *const pdo = values_of(node, target->ref.instance);
    if ((cob_id & ODS_COB_ID_RESERVED) != 0u) {
        return ODS_ABORT_INVALID_VALUE;
    }
    if ((cob_id & ODS_COB_ID_INVALID) != 0u) {
        return 0;
    }
    if (((cob_id & ODS_COB_ID_NO_REMOTE) == 0u) && (node->common->manufacturer_mode == 0u)) {
        return ODS_ABORT_INVALID_VALUE;
    }
    if (ods_can_id_restricted(cob_id & ODS_CAN_ID_MASK)) {
        return ODS_ABORT_INVALID_VALUE;
    }
    const int moves = ((cob_id ^ pdo->pdo_cob_id) & ODS_CAN_ID_MASK) != 0u;
    return (is_active(pdo) && moves) ? ODS_ABORT_INVALID_VALUE : 0u;
}

/* Find what a mapping entry names, if a PDO of this direction may carry it. */
static uint32_t resolve(const ods_node_t *node, uint32_t mapping, uint8_t direction, ods_od_ref_t *ref)
{
    const uint32_t abort = ods_od_find(node->od, (uint16_t)(mapping >> 16), (uint8_t)(mapping >> 8), ref);
    if (abort != 0u) {
        return abort;
    }
    const uint32_t kind = ref->entry->kind;
    if (((kind & direction) == 0u) || !ods_od_is_number(kind) || (bits_of(kind) != (mapping & 0xFFu))) {
        return ODS_ABORT_NOT_MAPPABLE;
    }
    return 0;
}

static uint8_t direction_of(const ods_node_t *node, uint32_t instance)
{
    return is_tpdo(node, instance) ? ODS_TX : ODS_RX;
}

/*
 * Whether the first `count` entries can be in force together. One of them may be about to be replaced: `replaced`
 * counts from 0, and is beyond them if none is.
 */
static uint32_t check_entries(
    const ods_node_t *node, uint32_t instance, uint32_t count, uint32_t replaced, uint32_t replacement)
{
    const uint32_t *const mapping = ods_pdo_mapping(values_of(node, instance));
    uint32_t bits = 0;
    for (uint32_t n = 0; n < count; n++) {
        const uint32_t entry = (n == replaced) ? replacement : mapping[n];
        ods_od_ref_t ref;
        const uint32_t abort = resolve(node, entry, direction_of(node, instance), &ref);
        if (abort != 0u) {
            return abort;
        }
        bits += entry & 0xFFu;
    }
    return (bits > MAX_BITS) ? ODS_ABORT_PDO_LENGTH : 0u;
}

uint32_t ods_pdo_check_count(const ods_node_t *node, const ods_target_t *target, uint32_t count)
{
    if (count > node->od->max_mapped) {
        return ODS_ABORT_PDO_LENGTH;
    }
    return check_entries(node, target->ref.instance, count, count, 0);
}

uint32_t ods_pdo_check_mapping(const ods_node_t *node, const ods_target_t *target, uint32_t mapping)
{
    const uint32_t count = values_of(node, target->ref.instance)->pdo_mapped_count;
    ods_od_ref_t ref;
    if (target->sub <= count) { /* in force, which manufacturer mode allows */
        return check_entries(node, target->ref.instance, count, target->sub - 1u, mapping);
    }
    return (mapping == 0u) ? 0u : resolve(node, mapping, direction_of(node, target->ref.instance), &ref);
}

/*
 * Resolve the mapping of an active PDO. Gives the number of its entries and their bits; both are 0 if it has none or
 * is not active. Stored parameters are no exception: what does not resolve is not in force.
 */
static uint32_t resolve_all(ods_node_t *node, uint32_t instance, uint32_t *bits)
{
    ods_pdo_values_t *const pdo = values_of(node, instance);
    const uint32_t *const mapping = ods_pdo_mapping(pdo);
    ods_pdo_ref_t *const refs = refs_of(node, instance);
    const uint32_t count = pdo->pdo_mapped_count;

    *bits = 0;
    if (!is_active(pdo) || (count > node->od->max_mapped) ||
        (check_entries(node, instance, count, count, 0) != 0u)) {
        return 0;
    }
    for (uint32_t n = 0; n < count; n++) {
        ods_od_ref_t ref = { NULL, 0 };
        (void)resolve(node, mapping[n], direction_of(node, instance), &ref);
        refs[n].entry = (uint16_t)(ref.entry - node->od->entries);
        refs[n].instance = ref.instance;
        *bits += mapping[n] & 0xFFu;
    }
    return count;
}

/* Chain the active RPDOs by CAN-ID, each chain ascending. */
static uint32_t bucket_of(uint32_t can_id)
{
    return (can_id ^ (can_id >> 4) ^ (can_id >> 8)) % ODS_PDO_BUCKETS;
}

static void chain_rpdos(ods_node_t *node)
{
    for (uint32_t n = 0; n < ODS_PDO_BUCKETS; n++) {
        node->pdo.buckets[n] = ODS_PDO_NONE;
    }
    for (uint32_t n = rpdo_count(node); n-- > 0u;) {
        if (node->pdo.rpdos[n].mapped != 0u) {
            uint16_t *const bucket = &node->pdo.buckets[bucket_of(rpdo_values(node, n)->pdo_cob_id & ODS_CAN_ID_MASK)];
            node->pdo.rpdos[n].next = *bucket;
            *bucket = (uint16_t)n;
        }
    }
}

static void load_rpdo(ods_node_t *node, uint32_t number)
{
    ods_rpdo_t *const rpdo = &node->pdo.rpdos[number];
    uint32_t bits;
    rpdo->mapped = (uint8_t)resolve_all(node, node->od->scope_instances[ODS_SCOPE_RPDO] + number, &bits);
    rpdo->length = (uint8_t)octets_of(bits);
    rpdo->is_held = 0;
    rpdo->syncs = 0;
}

static void start_event_timer(ods_node_t *node, ods_tpdo_t *tpdo, const ods_pdo_values_t *pdo)
{
    tpdo->flags &= (uint8_t)~TIMED;
    if ((pdo->pdo_event_timer != 0u) && !is_synchronous(pdo) && is_operational(node)) {
        tpdo->flags |= TIMED;
        tpdo->event_at = node->now + (pdo->pdo_event_timer * ODS_US_PER_MS);
        ods_wake_by(node, tpdo->event_at);
    }
}

/* A TPDO begins its work: it is sent once, whatever it carries. */
static void start_tpdo(ods_node_t *node, uint32_t number)
{
    ods_tpdo_t *const tpdo = &node->pdo.tpdos[number];
    tpdo->syncs = 0;
    tpdo->flags = DUE;
    start_event_timer(node, tpdo, tpdo_values(node, number));
    node->work |= ODS_WORK_TPDO;
}

static void load_tpdo(ods_node_t *node, uint32_t number)
{
    const uint32_t instance = node->od->scope_instances[ODS_SCOPE_TPDO] + number;
    const ods_pdo_ref_t *const refs = refs_of(node, instance);
    ods_tpdo_t *const tpdo = &node->pdo.tpdos[number];
    uint32_t bits;
    tpdo->mapped = (uint8_t)resolve_all(node, instance, &bits);
    tpdo->length = (uint8_t)octets_of(bits);
    tpdo->watched = 0;
    for (uint32_t n = 0; n < tpdo->mapped; n++) {
        tpdo->watched |= ods_instance_bit(refs[n].instance);
    }
    start_tpdo(node, number);
}

void ods_pdo_activate(ods_node_t *node, uint32_t instance)
{
    if (is_tpdo(node, instance)) {
        load_tpdo(node, instance - node->od->scope_instances[ODS_SCOPE_TPDO]);
    } else {
        load_rpdo(node, instance - node->od->scope_instances[ODS_SCOPE_RPDO]);
        chain_rpdos(node);
    }
}

void ods_pdo_cob_id_written(ods_node_t *node, uint32_t instance)
{
    const uint32_t first = node->od->scope_instances[is_tpdo(node, instance) ? ODS_SCOPE_TPDO : ODS_SCOPE_RPDO];
    const uint32_t number = instance - first;
    const uint32_t ran =
        is_tpdo(node, instance) ? node->pdo.tpdos[number].mapped : node->pdo.rpdos[number].mapped;
    if ((ran == 0u) || !is_active(values_of(node, instance))) {
        ods_pdo_activate(node, instance);
    } /* else nothing but bit 30 can have changed: it goes on */
}

void ods_pdo_parameter_written(ods_node_t *node, uint32_t instance, uint32_t sub)
{
    if (!is_tpdo(node, instance)) {
        node->pdo.rpdos[instance - node->od->scope_instances[ODS_SCOPE_RPDO]].syncs = 0;
        return;
    }
    const uint32_t number = instance - node->od->scope_instances[ODS_SCOPE_TPDO];
    ods_tpdo_t *const tpdo = &node->pdo.tpdos[number];
    if (sub == (uint32_t)SUB_TRANSMISSION_TYPE) {
        tpdo->syncs = 0;
    }
    if (sub != (uint32_t)SUB_INHIBIT_TIME) {
        start_event_timer(node, tpdo, tpdo_values(node, number));
    }
    tpdo->flags |= PENDING; /* have another look */
    node->work |= ODS_WORK_TPDO;
}

void ods_pdo_reset(ods_node_t *node)
{
    for (uint32_t n = 0; n < rpdo_count(node); n++) {
        load_rpdo(node, n);
    }
    for (uint32_t n = 0; n < tpdo_count(node); n++) {
        load_tpdo(node, n);
    }
    chain_rpdos(node);
}

void ods_pdo_start(ods_node_t *node)
{
    for (uint32_t n = 0; n < rpdo_count(node); n++) {
        node->pdo.rpdos[n].is_held = 0;
        node->pdo.rpdos[n].syncs = 0;
    }
    for (uint32_t n = 0; n < tpdo_count(node); n++) {
        start_tpdo(node, n);
    }
}

/* ---- data in ----------------------------------------------------------------------------------------------------- */

/* The next bits of a frame. */
static uint32_t take(const uint8_t *data, uint32_t at, uint32_t bits)
{
    uint32_t number = 0;
    for (uint32_t n = 0; n < bits; n += 8u) {
        const uint32_t octet = (at + n) >> 3;
        const uint32_t shift = (at + n) & 7u;
        uint32_t part = (uint32_t)data[octet] >> shift;
        if ((shift != 0u) && (bits - n > 8u - shift)) {
            part |= (uint32_t)data[octet + 1u] << (8u - shift);
        }
        number |= (part & 0xFFu) << n;
    }
    return (bits < 32u) ? (number & ((1u << bits) - 1u)) : number;
}

/* Write what a frame carries, entry by entry; the first one that is refused ends it. */
static void apply(ods_node_t *node, uint32_t number, const uint8_t *data)
{
    const ods_rpdo_t *const rpdo = &node->pdo.rpdos[number];
    const ods_pdo_ref_t *const refs = refs_of(node, node->od->scope_instances[ODS_SCOPE_RPDO] + number);
    uint32_t at = 0;
    for (uint32_t n = 0; n < rpdo->mapped; n++) {
        const ods_target_t target = { { &node->od->entries[refs[n].entry], refs[n].instance }, 0, 0 };
        const uint32_t bits = bits_of(target.ref.entry->kind);
        uint32_t abort;
        if (bits > 32u) {
            uint8_t octets[8];
            for (uint32_t octet = 0; octet < 8u; octet++) {
                octets[octet] = (uint8_t)take(data, at + (8u * octet), 8u);
            }
            abort = ods_access_write(node, &target, octets, 8);
        } else {
            abort = ods_access_write_number(node, &target, take(data, at, bits));
        }
        if (abort != 0u) {
            ods_emcy_raise(node, ODS_CONDITION_PARAMETER_REFUSED, ODS_ALL_AXES);
            return;
        }
        at += bits;
    }
}

void ods_pdo_receive(ods_node_t *node, const ods_frame_t *frame)
{
    uint32_t number = node->pdo.buckets[bucket_of(frame->id)];
    while (number != ODS_PDO_NONE) {
        ods_rpdo_t *const rpdo = &node->pdo.rpdos[number];
        const ods_pdo_values_t *const pdo = rpdo_values(node, number);
        if ((pdo->pdo_cob_id & ODS_CAN_ID_MASK) == frame->id) {
            if (frame->length != rpdo->length) {
                const int is_short = frame->length < rpdo->length;
                ods_emcy_raise(node, is_short ? ODS_CONDITION_PDO_TOO_SHORT : ODS_CONDITION_PDO_TOO_LONG, ODS_ALL_AXES);
            } else if (is_synchronous(pdo)) {
                memcpy(rpdo->held, frame->data, sizeof rpdo->held);
                rpdo->is_held = 1;
            } else {
                apply(node, number, frame->data);
            }
        }
        number = rpdo->next;
    }
}

/* ---- data out ---------------------------------------------------------------------------------------------------- */

static void put(uint8_t *image, uint32_t at, uint32_t number, uint32_t bits)
{
    for (uint32_t n = 0; n < bits; n += 8u) {
        const uint32_t part = (number >> n) & 0xFFu;
        const uint32_t octet = (at + n) >> 3;
        const uint32_t shift = (at + n) & 7u;
        image[octet] = (uint8_t)(image[octet] | part << shift);
        if ((shift != 0u) && ((part << shift) > 0xFFu)) {
            image[octet + 1u] = (uint8_t)(part >> (8u - shift));
        }
    }
}

/* The present values of what a TPDO carries. */
static void sample(ods_node_t *node, uint32_t number, uint8_t image[8])
{
    const ods_tpdo_t *const tpdo = &node->pdo.tpdos[number];
    const ods_pdo_ref_t *const refs = refs_of(node, node->od->scope_instances[ODS_SCOPE_TPDO] + number);
    uint32_t at = 0;
    memset(image, 0, 8);
    for (uint32_t n = 0; n < tpdo->mapped; n++) {
        const ods_od_ref_t ref = { &node->od->entries[refs[n].entry], refs[n].instance };
        const uint32_t bits = bits_of(ref.entry->kind);
        if (bits > 32u) {
            uint8_t octets[8];
            uint16_t length;
            (void)ods_od_octets(node->od, node->values, &ref, octets, &length);
            for (uint32_t octet = 0; octet < 8u; octet++) {
                put(image, at + (8u * octet), octets[octet], 8u);
            }
        } else {
            put(image, at, ods_od_number(node->od, node->values, &ref), bits);
        }
        at += bits;
    }
}

static void send_tpdo(ods_node_t *node, uint32_t number, const uint8_t image[8])
{
    ods_tpdo_t *const tpdo = &node->pdo.tpdos[number];
    const ods_pdo_values_t *const pdo = tpdo_values(node, number);
    ods_frame_t frame;
    frame.id = (uint16_t)(pdo->pdo_cob_id & ODS_CAN_ID_MASK);
    frame.length = tpdo->length;
    frame.remote = 0;
    memcpy(frame.data, image, sizeof frame.data);
    memcpy(tpdo->image, image, sizeof tpdo->image);
    tpdo->flags = SENT;
    tpdo->sent_at = node->now;
    start_event_timer(node, tpdo, pdo);
    ods_send(node, &frame);
}

void ods_pdo_sync(ods_node_t *node)
{
    uint8_t image[8];
    if (!is_operational(node)) {
        return;
    }
    for (uint32_t n = 0; n < tpdo_count(node); n++) {
        ods_tpdo_t *const tpdo = &node->pdo.tpdos[n];
        const ods_pdo_values_t *const pdo = tpdo_values(node, n);
        if ((tpdo->mapped != 0u) && is_synchronous(pdo) && (++tpdo->syncs >= pdo->pdo_transmission_type)) {
            tpdo->syncs = 0;
            sample(node, n, image);
            send_tpdo(node, n, image);
        }
    }
    for (uint32_t n = 0; n < rpdo_count(node); n++) {
        ods_rpdo_t *const rpdo = &node->pdo.rpdos[n];
        const ods_pdo_values_t *const pdo = rpdo_values(node, n);
        if ((rpdo->mapped != 0u) && is_synchronous(pdo) && (++rpdo->syncs >= pdo->pdo_transmission_type)) {
            rpdo->syncs = 0;
            if (rpdo->is_held != 0u) {
                rpdo->is_held = 0;
                apply(node, n, rpdo->held);
            }
        }
    }
}

/* Whether a TPDO has to wait, and until when. */
static int is_inhibited(const ods_node_t *node, const ods_tpdo_t *tpdo, const ods_pdo_values_t *pdo, uint32_t *until)
{
    *until = tpdo->sent_at + (pdo->pdo_inhibit_time * ODS_US_PER_100US);
    return ((tpdo->flags & SENT) != 0u) && ods_before(node->now, *until);
}

uint32_t ods_pdo_earliest(const ods_node_t *node, uint32_t at)
{
    uint32_t earliest = at;
    uint32_t until;
    if (!is_operational(node)) {
        return at;
    }
    for (uint32_t n = 0; n < tpdo_count(node); n++) {
        const ods_tpdo_t *const tpdo = &node->pdo.tpdos[n];
        if ((tpdo->mapped == 0u) || (tpdo->flags == 0u)) {
            continue;
        }
        if (((tpdo->flags & TIMED) != 0u) && ods_before(tpdo->event_at, earliest)) {
            earliest = tpdo->event_at;
        }
        if (((tpdo->flags & (DUE | PENDING)) != 0u) && !is_synchronous(tpdo_values(node, n)) &&
            is_inhibited(node, tpdo, tpdo_values(node, n), &until) && ods_before(until, earliest)) {
            earliest = until;
        }
    }
    return earliest;
}

void ods_pdo_expire(ods_node_t *node)
{
    if (!is_operational(node)) {
        return;
    }
    for (uint32_t n = 0; n < tpdo_count(node); n++) {
        ods_tpdo_t *const tpdo = &node->pdo.tpdos[n];
        if (((tpdo->flags & TIMED) != 0u) && !ods_before(node->now, tpdo->event_at)) {
            tpdo->flags = (uint8_t)((tpdo->flags & ~TIMED) | DUE);
        }
        if (((tpdo->flags & SENT) != 0u) && (node->now - tpdo->sent_at >= LONG_AGO_US)) {
            tpdo->flags &= (uint8_t)~SENT;
        }
        if ((tpdo->flags & (DUE | PENDING)) != 0u) {
            node->work |= ODS_WORK_TPDO;
        }
    }
}

void ods_pdo_transmit(ods_node_t *node)
{
    uint8_t image[8];
    uint32_t until;
    if (!is_operational(node)) {
        node->changed = 0;
        return;
    }
    if (node->can == (uint8_t)ODS_CAN_BUS_OFF) {
        return;
    }
    for (uint32_t n = 0; n < tpdo_count(node); n++) {
        ods_tpdo_t *const tpdo = &node->pdo.tpdos[n];
        const ods_pdo_values_t *const pdo = tpdo_values(node, n);
        if ((tpdo->mapped == 0u) || is_synchronous(pdo) ||
            (((tpdo->flags & (DUE | PENDING)) == 0u) && ((tpdo->watched & node->changed) == 0u))) {
            continue;
        }
        if (is_inhibited(node, tpdo, pdo, &until)) {
            tpdo->flags |= PENDING;
            ods_wake_by(node, until);
            continue;
        }
        sample(node, n, image);
        if (((tpdo->flags & DUE) != 0u) || (memcmp(image, tpdo->image, sizeof image) != 0)) {
            send_tpdo(node, n, image);
        } else {
            tpdo->flags &= (uint8_t)~PENDING;
        }
    }
    node->changed = 0;
}
