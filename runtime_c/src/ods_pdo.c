#include "ods_pdo.h"

#include <string.h>

#include "ods_access.h"
#include "ods_can.h"
#include "ods_core.h"
#include "ods_emcy.h"
#include "ods_od.h"

#define MAX_BITS 64u
#define SYNCHRONOUS_LAST 240u /* transmission types 1 to 240 */

/* Sub-indices of a communication parameter record. */
enum {
    SUB_TRANSMISSION_TYPE = 2,
    SUB_INHIBIT_TIME = 3
};

/* ods_pdo_common_t.flags */
#define DUE 0x01u /* TPDO: has to be sent, changed or not */
#define PENDING 0x02u /* TPDO: waits for the end of its inhibit time */
#define SENT 0x04u /* TPDO: `sent_at` is that of a transmission not long ago */
#define TIMED 0x08u /* TPDO: its event timer runs */
#define HELD 0x10u /* RPDO: a frame waits for its SYNC */
#define BITWISE 0x80u /* `refs` are not used: not all entries are simple, see is_simple() */

/* A transmission that is longer ago no longer inhibits, and its instant would soon be ambiguous. */
#define LONG_AGO_US 0x10000000u

/* ---- from a PDO to its parts ------------------------------------------------------------------------------------- */

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

static ods_rpdo_t *rpdo_of(const ods_node_t *node, uint32_t instance)
{
    return &node->pdo.rpdos[instance - node->od->scope_instances[ODS_SCOPE_RPDO]];
}

static ods_tpdo_t *tpdo_of(const ods_node_t *node, uint32_t instance)
{
    return &node->pdo.tpdos[instance - node->od->scope_instances[ODS_SCOPE_TPDO]];
}

static ods_pdo_common_t *pdo_of(const ods_node_t *node, uint32_t instance)
{
    return is_tpdo(node, instance) ? &tpdo_of(node, instance)->pdo : &rpdo_of(node, instance)->pdo;
}

static int is_active(const ods_pdo_common_t *pdo)
{
    return (pdo->values->pdo_cob_id & ODS_COB_ID_INVALID) == 0u;
}

static int is_synchronous(const ods_pdo_common_t *pdo)
{
    return (pdo->values->pdo_transmission_type >= 1u) && (pdo->values->pdo_transmission_type <= SYNCHRONOUS_LAST);
}

static uint32_t can_id_of(const ods_pdo_common_t *pdo)
{
    return pdo->values->pdo_cob_id & ODS_CAN_ID_MASK;
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

/* ---- parameters -------------------------------------------------------------------------------------------------- */

uint32_t ods_pdo_mapping_state(const ods_node_t *node, uint32_t instance, uint32_t sub)
{
    const ods_pdo_common_t *const pdo = pdo_of(node, instance);
    if (node->common->manufacturer_mode != 0u) {
        return 0;
    }
    const int is_in_force = (sub != 0u) && (pdo->values->pdo_mapped_count != 0u);
    return (is_in_force || is_active(pdo)) ? ODS_ABORT_DEVICE_STATE : 0u;
}

uint32_t ods_pdo_check_cob_id(const ods_node_t *node, uint32_t instance, uint32_t cob_id)
{
    const ods_pdo_common_t *const pdo = pdo_of(node, instance);
    const int is_usable =
        ((cob_id & ODS_COB_ID_INVALID) != 0u) ||
        ((((cob_id & ODS_COB_ID_NO_REMOTE) != 0u) || (node->common->manufacturer_mode != 0u)) &&
         !ods_can_id_restricted(cob_id) &&
         (!is_active(pdo) || (can_id_of(pdo) == (cob_id & ODS_CAN_ID_MASK))));
    return (is_usable && ((cob_id & ODS_COB_ID_RESERVED) == 0u)) ? 0u : ODS_ABORT_INVALID_VALUE;
}

/* Find what a mapping entry names, if a PDO of this direction may carry it. */
static uint32_t resolve(const ods_node_t *node, uint32_t mapping, uint32_t direction, ods_od_ref_t *ref)
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

static uint32_t direction_of(const ods_node_t *node, uint32_t instance)
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
    const uint32_t *const mapping = ods_pdo_mapping(pdo_of(node, instance)->values);
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

uint32_t ods_pdo_check_count(const ods_node_t *node, uint32_t instance, uint32_t count)
{
    if (count > node->od->max_mapped) {
        return ODS_ABORT_PDO_LENGTH;
    }
    return check_entries(node, instance, count, count, 0);
}

uint32_t ods_pdo_check_mapping(const ods_node_t *node, uint32_t instance, uint32_t sub, uint32_t mapping)
{
    const uint32_t count = pdo_of(node, instance)->values->pdo_mapped_count;
    ods_od_ref_t ref;
    if (sub <= count) { /* in force, which manufacturer mode allows */
        return check_entries(node, instance, count, sub - 1u, mapping);
    }
    return (mapping == 0u) ? 0u : resolve(node, mapping, direction_of(node, instance), &ref);
}

/* ---- coming into force ------------------------------------------------------------------------------------------- */

/*
 * Whether an entry is a number of up to 4 octets in memory. Where all of them are, each begins with an octet of the
 * frame.
 */
static int is_simple(uint32_t kind)
{
    return ods_od_is_short(kind) && ((kind & ODS_CONST) == 0u) && ((kind & ODS_TYPE_MASK) != ODS_BOOL);
}

/*
 * Resolve the mapping of a PDO, if it is active and has one. Stored parameters are no exception: what does not resolve
 * is not in force. Gives what a TPDO watches.
 */
static uint32_t resolve_all(ods_node_t *node, uint32_t instance)
{
    ods_pdo_common_t *const pdo = pdo_of(node, instance);
    const uint32_t *const mapping = ods_pdo_mapping(pdo->values);
    const uint32_t count = is_active(pdo) ? pdo->values->pdo_mapped_count : 0u;
    uint32_t watched = 0;
    uint32_t bits = 0;

    pdo->mapped = 0;
    pdo->flags &= (uint8_t)~BITWISE;
    if (count > node->od->max_mapped) {
        return 0;
    }
    for (uint32_t n = 0; n < count; n++) {
        ods_od_ref_t found;
        ods_pdo_ref_t *const ref = &pdo->refs[n];
        if (resolve(node, mapping[n], direction_of(node, instance), &found) != 0u) {
            return 0;
        }
        const uint32_t kind = found.entry->kind;
        if (!is_simple(kind)) {
            pdo->flags |= BITWISE;
        }
        ref->at = is_tpdo(node, instance) ? (uint16_t)(node->od->bases[found.instance] + found.entry->at)
                                          : (uint16_t)(found.entry - node->od->entries);
        ref->instance = (uint8_t)found.instance;
        ref->place = (uint8_t)((kind & 3u) << 4 | bits >> 3);
        watched |= ods_instance_bit(found.instance) | ods_entry_bit(found.entry);
        bits += mapping[n] & 0xFFu;
    }
    if (bits > MAX_BITS) {
        return 0;
    }
    pdo->mapped = (uint8_t)count;
    pdo->length = (uint8_t)((bits + 7u) / 8u);
    return watched;
}

static uint32_t bucket_of(uint32_t can_id)
{
    return (can_id ^ (can_id >> 4) ^ (can_id >> 8)) % ODS_PDO_BUCKETS;
}

/* Chain the active PDOs. */
static void chain(ods_node_t *node)
{
    ods_pdo_t *const pdos = &node->pdo;
    memset(pdos->buckets, 0, sizeof pdos->buckets);
    pdos->synchronous_rpdos = NULL;
    pdos->synchronous_tpdos = NULL;
    pdos->event_tpdos = NULL;
    pdos->watched = 0;
    for (uint32_t n = rpdo_count(node); n-- > 0u;) {
        ods_rpdo_t *const rpdo = &pdos->rpdos[n];
        if (rpdo->pdo.mapped != 0u) {
            ods_rpdo_t **const bucket = &pdos->buckets[bucket_of(can_id_of(&rpdo->pdo))];
            rpdo->next = *bucket;
            *bucket = rpdo;
            if (is_synchronous(&rpdo->pdo)) {
                rpdo->next_synchronous = pdos->synchronous_rpdos;
                pdos->synchronous_rpdos = rpdo;
            }
        }
    }
    for (uint32_t n = tpdo_count(node); n-- > 0u;) {
        ods_tpdo_t *const tpdo = &pdos->tpdos[n];
        if (tpdo->pdo.mapped != 0u) {
            ods_tpdo_t **const first = is_synchronous(&tpdo->pdo) ? &pdos->synchronous_tpdos : &pdos->event_tpdos;
            tpdo->next = *first;
            *first = tpdo;
            pdos->watched |= tpdo->watched;
        }
    }
}

static void start_rpdo(ods_rpdo_t *rpdo)
{
    rpdo->pdo.syncs = 0;
    rpdo->pdo.flags &= (uint8_t)~HELD;
}

static void start_event_timer(ods_node_t *node, ods_tpdo_t *tpdo)
{
    const uint32_t time = tpdo->pdo.values->pdo_event_timer * ODS_US_PER_MS;
    tpdo->pdo.flags &= (uint8_t)~TIMED;
    if ((time != 0u) && !is_synchronous(&tpdo->pdo) && is_operational(node)) {
        tpdo->pdo.flags |= TIMED;
        tpdo->event_at = node->now + time;
        ods_wake_by(node, tpdo->event_at);
    }
}

/* A TPDO begins its work: it is sent once, whatever it carries. */
static void start_tpdo(ods_node_t *node, ods_tpdo_t *tpdo)
{
    tpdo->pdo.syncs = 0;
    tpdo->pdo.flags = (uint8_t)((tpdo->pdo.flags & (SENT | BITWISE)) | DUE); /* the inhibit time goes on */
    start_event_timer(node, tpdo);
    node->work |= ODS_WORK_TPDO;
}

static void load(ods_node_t *node, uint32_t instance)
{
    const uint32_t watched = resolve_all(node, instance);
    if (!is_tpdo(node, instance)) {
        start_rpdo(rpdo_of(node, instance));
    } else if (watched != 0u) {
        tpdo_of(node, instance)->watched = watched;
        start_tpdo(node, tpdo_of(node, instance));
    }
}

/* Parameters of a PDO have changed: it starts afresh, or stops. */
static void activate(ods_node_t *node, uint32_t instance)
{
    const ods_pdo_common_t *const pdo = pdo_of(node, instance);
    if (is_active(pdo) || (pdo->mapped != 0u)) {
        load(node, instance);
        chain(node);
    }
}

void ods_pdo_cob_id_written(ods_node_t *node, uint32_t instance)
{
    const ods_pdo_common_t *const pdo = pdo_of(node, instance);
    if ((pdo->mapped == 0u) || !is_active(pdo)) {
        activate(node, instance);
    } /* else nothing but bit 30 can have changed: it goes on */
}

void ods_pdo_mapping_written(ods_node_t *node, uint32_t instance, uint32_t sub)
{
    if (sub <= pdo_of(node, instance)->values->pdo_mapped_count) {
        activate(node, instance);
    } /* else it stands behind the entries in force */
}

void ods_pdo_parameter_written(ods_node_t *node, uint32_t instance, uint32_t sub)
{
    ods_pdo_common_t *const pdo = pdo_of(node, instance);
    if (pdo->mapped == 0u) {
        return; /* it will start afresh */
    }
    if (is_tpdo(node, instance)) {
        if (sub != (uint32_t)SUB_INHIBIT_TIME) {
            start_event_timer(node, tpdo_of(node, instance));
        }
        pdo->flags |= PENDING; /* have another look */
        node->work |= ODS_WORK_TPDO;
    } else {
        start_rpdo(rpdo_of(node, instance));
    }
    if (sub == (uint32_t)SUB_TRANSMISSION_TYPE) {
        pdo->syncs = 0;
        chain(node);
    }
}

void ods_pdo_reset(ods_node_t *node)
{
    const uint32_t first = node->od->scope_instances[ODS_SCOPE_RPDO];
    for (uint32_t n = 0; n < rpdo_count(node) + tpdo_count(node); n++) {
        ods_pdo_common_t *const pdo = pdo_of(node, first + n);
        pdo->values = (ods_pdo_values_t *)ods_od_instance(node->od, node->values, first + n);
        pdo->refs = &node->pdo.mapped[n * node->od->max_mapped];
        pdo->flags = 0;
        load(node, first + n);
    }
    chain(node);
}

void ods_pdo_start(ods_node_t *node)
{
    for (uint32_t n = 0; n < rpdo_count(node); n++) {
        start_rpdo(&node->pdo.rpdos[n]);
    }
    for (uint32_t n = 0; n < tpdo_count(node); n++) {
        start_tpdo(node, &node->pdo.tpdos[n]);
    }
}

/* ---- bit by bit -------------------------------------------------------------------------------------------------- */

/* Bits from one place to another that is 0; both count from the lowest bit of an octet. */
static void copy_bits(uint8_t *to, uint32_t to_bit, const uint8_t *from, uint32_t from_bit, uint32_t count)
{
    for (uint32_t n = 0; n < count; n++) {
        const uint32_t bit = ((uint32_t)from[(from_bit + n) >> 3] >> ((from_bit + n) & 7u)) & 1u;
        to[(to_bit + n) >> 3] |= (uint8_t)(bit << ((to_bit + n) & 7u));
    }
}

ODS_RARE static uint32_t write_bits(ods_node_t *node, const ods_pdo_common_t *pdo, const uint8_t *data)
{
    const uint32_t *const mapping = ods_pdo_mapping(pdo->values);
    uint32_t abort = 0;
    uint32_t bit = 0;
    for (uint32_t n = 0; (n < pdo->mapped) && (abort == 0u); n++) {
        const uint32_t bits = mapping[n] & 0xFFu;
        ods_od_ref_t ref = { NULL, 0 };
        uint8_t octets[8] = { 0 };
        (void)resolve(node, mapping[n], ODS_RX, &ref);
        copy_bits(octets, 0, data, bit, bits);
        abort = ods_access_write(node, &ref, octets, (uint16_t)((bits + 7u) / 8u));
        bit += bits;
    }
    return abort;
}

ODS_RARE static void sample_bits(const ods_node_t *node, const ods_pdo_common_t *pdo, uint8_t *data)
{
    const uint32_t *const mapping = ods_pdo_mapping(pdo->values);
    uint32_t bit = 0;
    for (uint32_t n = 0; n < pdo->mapped; n++) {
        ods_od_ref_t ref = { NULL, 0 };
        uint8_t number[8];
        uint16_t length;
        (void)resolve(node, mapping[n], ODS_TX, &ref);
        copy_bits(data, bit, ods_od_octets(node->od, node->values, &ref, number, &length), 0, mapping[n] & 0xFFu);
        bit += mapping[n] & 0xFFu;
    }
}

/* ---- data in ----------------------------------------------------------------------------------------------------- */

/* Write what a frame carries, entry by entry; the first one that is refused ends it. */
static uint32_t write_octets(ods_node_t *node, const ods_pdo_common_t *pdo, const uint8_t *data)
{
    const ods_pdo_ref_t *ref = pdo->refs;
    uint32_t left = pdo->mapped;
    uint32_t abort;
    do {
        const uint8_t *const from = &data[ref->place & 7u];
        const uint32_t size = (uint32_t)ref->place >> 4;
        const uint32_t number = (size == 0u) ? from[0] : ((size == 1u) ? ods_get_16(from) : ods_get_32(from));
        abort = ods_access_write_number(node, &node->od->entries[ref->at], ref->instance, number);
        ref++;
    } while ((--left != 0u) && (abort == 0u));
    return abort;
}

static void apply(ods_node_t *node, const ods_pdo_common_t *pdo, const uint8_t *data)
{
    const uint32_t abort =
        ((pdo->flags & BITWISE) == 0u) ? write_octets(node, pdo, data) : write_bits(node, pdo, data);
    if (abort != 0u) {
        ods_emcy_raise(node, ODS_CONDITION_PARAMETER_REFUSED, ODS_ALL_AXES);
    }
}

void ods_pdo_receive(ods_node_t *node, const ods_frame_t *frame)
{
    for (ods_rpdo_t *rpdo = node->pdo.buckets[bucket_of(frame->id)]; rpdo != NULL; rpdo = rpdo->next) {
        if (can_id_of(&rpdo->pdo) != frame->id) {
            continue;
        }
        if (frame->length != rpdo->pdo.length) {
            const int is_short = frame->length < rpdo->pdo.length;
            ods_emcy_raise(node, is_short ? ODS_CONDITION_PDO_TOO_SHORT : ODS_CONDITION_PDO_TOO_LONG, ODS_ALL_AXES);
        } else if (is_synchronous(&rpdo->pdo)) {
            memcpy(rpdo->held, frame->data, sizeof rpdo->held);
            rpdo->pdo.flags |= HELD;
        } else {
            apply(node, &rpdo->pdo, frame->data);
        }
    }
}

/* ---- data out ---------------------------------------------------------------------------------------------------- */

/* The present values of what a TPDO carries. */
static void sample(const ods_node_t *node, const ods_pdo_common_t *pdo, uint8_t *data)
{
    const uint8_t *const values = node->values;
    const ods_pdo_ref_t *ref = pdo->refs;
    uint32_t left = pdo->mapped;
    memset(data, 0, 8);
    if ((pdo->flags & BITWISE) != 0u) {
        sample_bits(node, pdo, data);
        return;
    }
    do {
        uint8_t *const to = &data[ref->place & 7u];
        const void *const value = values + ref->at;
        const uint32_t size = (uint32_t)ref->place >> 4;
        if (size == 0u) {
            *to = *(const uint8_t *)value;
        } else if (size == 1u) {
            ods_put_16(to, *(const uint16_t *)value);
        } else {
            ods_put_32(to, *(const uint32_t *)value);
        }
        ref++;
    } while (--left != 0u);
}

/* Send a frame that holds what a TPDO carries. */
static void send_tpdo(ods_node_t *node, ods_tpdo_t *tpdo, ods_frame_t *frame)
{
    frame->id = (uint16_t)can_id_of(&tpdo->pdo);
    frame->length = tpdo->pdo.length;
    frame->remote = 0;
    memcpy(tpdo->image, frame->data, sizeof tpdo->image);
    tpdo->pdo.flags = (uint8_t)((tpdo->pdo.flags & BITWISE) | SENT);
    tpdo->sent_at = node->now;
    ods_send(node, frame);
}

/* Whether a SYNC is the n-th one. */
static int counts_sync(ods_pdo_common_t *pdo)
{
    if (++pdo->syncs < pdo->values->pdo_transmission_type) {
        return 0;
    }
    pdo->syncs = 0;
    return 1;
}

void ods_pdo_sync(ods_node_t *node)
{
    for (ods_tpdo_t *tpdo = node->pdo.synchronous_tpdos; tpdo != NULL; tpdo = tpdo->next) {
        if (counts_sync(&tpdo->pdo)) {
            ods_frame_t frame;
            sample(node, &tpdo->pdo, frame.data);
            send_tpdo(node, tpdo, &frame);
        }
    }
    for (ods_rpdo_t *rpdo = node->pdo.synchronous_rpdos; rpdo != NULL; rpdo = rpdo->next_synchronous) {
        if (counts_sync(&rpdo->pdo) && ((rpdo->pdo.flags & HELD) != 0u)) {
            rpdo->pdo.flags &= (uint8_t)~HELD;
            apply(node, &rpdo->pdo, rpdo->held);
        }
    }
}

static uint32_t inhibited_until(const ods_tpdo_t *tpdo)
{
    return tpdo->sent_at + (tpdo->pdo.values->pdo_inhibit_time * ODS_US_PER_100US);
}

/* Whether a TPDO has to wait. */
static int is_inhibited(const ods_node_t *node, const ods_tpdo_t *tpdo)
{
    return ((tpdo->pdo.flags & SENT) != 0u) && ods_before(node->now, inhibited_until(tpdo));
}

uint32_t ods_pdo_earliest(const ods_node_t *node, uint32_t at)
{
    uint32_t earliest = at;
    if (!is_operational(node)) {
        return at;
    }
    for (const ods_tpdo_t *tpdo = node->pdo.event_tpdos; tpdo != NULL; tpdo = tpdo->next) {
        const uint32_t until = inhibited_until(tpdo);
        if (((tpdo->pdo.flags & TIMED) != 0u) && ods_before(tpdo->event_at, earliest)) {
            earliest = tpdo->event_at;
        }
        if (((tpdo->pdo.flags & (DUE | PENDING)) != 0u) && is_inhibited(node, tpdo) && ods_before(until, earliest)) {
            earliest = until;
        }
    }
    return earliest;
}

/* Forget transmissions that are long ago, of inactive TPDOs too. */
static void age(ods_node_t *node)
{
    node->pdo.aged_at = node->now;
    for (uint32_t n = 0; n < tpdo_count(node); n++) {
        ods_tpdo_t *const tpdo = &node->pdo.tpdos[n];
        if (node->now - tpdo->sent_at >= LONG_AGO_US) {
            tpdo->pdo.flags &= (uint8_t)~SENT;
        }
    }
}

void ods_pdo_expire(ods_node_t *node)
{
    if (node->now - node->pdo.aged_at >= LONG_AGO_US) {
        age(node);
    }
    for (ods_tpdo_t *tpdo = node->pdo.event_tpdos; tpdo != NULL; tpdo = tpdo->next) {
        if (((tpdo->pdo.flags & TIMED) != 0u) && !ods_before(node->now, tpdo->event_at)) {
            tpdo->pdo.flags = (uint8_t)((tpdo->pdo.flags & ~TIMED) | DUE);
        }
        if ((tpdo->pdo.flags & (DUE | PENDING)) != 0u) {
            node->work |= ODS_WORK_TPDO;
        }
    }
}

/* What a TPDO would carry now is sent if it has changed, or if it is due anyway. */
static void transmit(ods_node_t *node, ods_tpdo_t *tpdo)
{
    ods_frame_t frame;
    sample(node, &tpdo->pdo, frame.data);
    if (((tpdo->pdo.flags & DUE) == 0u) && (memcmp(frame.data, tpdo->image, sizeof tpdo->image) == 0)) {
        if (!is_inhibited(node, tpdo)) {
            tpdo->pdo.flags &= (uint8_t)~PENDING;
        }
    } else if (is_inhibited(node, tpdo)) {
        tpdo->pdo.flags |= PENDING;
        ods_wake_by(node, inhibited_until(tpdo));
    } else {
        send_tpdo(node, tpdo, &frame);
        start_event_timer(node, tpdo);
    }
}

void ods_pdo_transmit(ods_node_t *node)
{
    if (!is_operational(node) || (node->can == (uint8_t)ODS_CAN_BUS_OFF)) {
        return;
    }
    for (ods_tpdo_t *tpdo = node->pdo.event_tpdos; tpdo != NULL; tpdo = tpdo->next) {
        if (((tpdo->pdo.flags & (DUE | PENDING)) != 0u) || ((tpdo->watched & node->changed) != 0u)) {
            transmit(node, tpdo);
        }
    }
    node->changed = 0;
}
