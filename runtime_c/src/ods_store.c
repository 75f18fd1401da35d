#include "ods_store.h"

#include <string.h>

#include "ods_core.h"
#include "ods_od.h"

#define HEADER 12u
#define BANKS 2u
#define DEVICE_OWNER 0u /* owner 1 + n is axis n */

/* ---- memory, octet by octet, with the checksum of what went by --------------------------------------------------- */

typedef struct {
    const ods_node_t *node;
    uint32_t at;
    uint32_t crc;
    int failed;
} tape_t;

/* CRC-32 as in IEEE 802.3, bit by bit: no table to keep in flash. */
static uint32_t crc_32(uint32_t crc, uint8_t octet)
{
    uint32_t value = crc ^ octet;
    for (uint32_t bit = 0; bit < 8u; bit++) {
        value = (value >> 1) ^ (0xEDB88320u & (0u - (value & 1u)));
    }
    return value;
}

static uint8_t read_octet(tape_t *tape)
{
    const ods_port_t *const port = tape->node->port;
    uint8_t octet = 0;
    if (!tape->failed && ((port->nvm_read == NULL) || (port->nvm_read(port->context, tape->at, &octet) != 0))) {
        tape->failed = 1;
    }
    tape->at++;
    tape->crc = crc_32(tape->crc, octet);
    return octet;
}

static uint32_t read_number(tape_t *tape, uint32_t octets)
{
    uint32_t number = 0;
    for (uint32_t n = 0; n < octets; n++) {
        number |= (uint32_t)read_octet(tape) << (8u * n);
    }
    return number;
}

static void write_octet(tape_t *tape, uint8_t octet)
{
    const ods_port_t *const port = tape->node->port;
    if (!tape->failed && ((port->nvm_write == NULL) || (port->nvm_write(port->context, tape->at, octet) != 0))) {
        tape->failed = 1;
    }
    tape->at++;
    tape->crc = crc_32(tape->crc, octet);
}

static void write_number(tape_t *tape, uint32_t number, uint32_t octets)
{
    for (uint32_t n = 0; n < octets; n++) {
        write_octet(tape, (uint8_t)(number >> (8u * n)));
    }
}

static tape_t tape_at(const ods_node_t *node, uint32_t at)
{
    const tape_t tape = { node, at, 0xFFFFFFFFu, 0 };
    return tape;
}

/* ---- what a record consists of ----------------------------------------------------------------------------------- */

static uint32_t owners(const ods_device_t *device)
{
    return 1u + device->axes;
}

/* Whose groups decide about the values of an instance: those of PDOs belong to the device. */
static uint32_t owner_of(const ods_od_t *od, uint32_t instance)
{
    return (instance < od->scope_instances[ODS_SCOPE_RPDO]) ? instance : DEVICE_OWNER;
}

static uint32_t scope_of(const ods_od_t *od, uint32_t instance)
{
    uint32_t scope = ODS_SCOPE_DEVICE;
    while (instance >= od->scope_instances[scope + 1u]) {
        scope++;
    }
    return scope;
}

static uint32_t group_of(const ods_od_t *od, const ods_od_entry_t *entry)
{
    const uint32_t group = (entry->kind == 0u) ? 0u : od->rules[entry->rule].group;
    return (group == 0u) ? 0u : 1u << (group - 1u);
}

static uint32_t payload_size(const ods_device_t *device)
{
    const ods_od_t *const od = device->od;
    uint32_t size = 2u * owners(device);
    for (uint32_t scope = 0; scope < (uint32_t)ODS_SCOPES; scope++) {
        const uint32_t instances = (uint32_t)od->scope_instances[scope + 1u] - od->scope_instances[scope];
        for (uint32_t n = od->scope_entries[scope]; n < od->scope_entries[scope + 1u]; n++) {
            if (group_of(od, &od->entries[n]) != 0u) {
                size += instances * ods_od_room(od, &od->entries[n]);
            }
        }
    }
    return size;
}

static uint32_t bank_address(const ods_device_t *device, uint32_t bank)
{
    return bank * (HEADER + payload_size(device));
}

uint32_t ods_store_size(const ods_device_t *device)
{
    return bank_address(device, BANKS);
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static int is_valid(const ods_node_t *node, uint32_t bank, uint16_t *sequence, int *failed)
{
    const uint32_t size = payload_size(node->device);
    tape_t tape = tape_at(node, bank_address(node->device, bank));
    const uint32_t layout = read_number(&tape, 4);
    *sequence = (uint16_t)read_number(&tape, 2);
    const uint32_t length = read_number(&tape, 2);
    const uint32_t crc = tape.crc;
    const uint32_t expected = read_number(&tape, 4);
    const int is_ours = (layout == node->od->layout) && (length == size);
    tape.crc = crc;
    for (uint32_t n = 0; is_ours && (n < size); n++) {
        (void)read_octet(&tape);
    }
    *failed |= tape.failed;
    return is_ours && !tape.failed && (~tape.crc == expected);
}

/* The bank whose record is in force. Returns 0, or the abort code of a memory that cannot be read. */
static uint32_t find_record(ods_node_t *node)
{
    int failed = 0;
    node->store.bank = ODS_NONE;
    node->store.sequence = 0;
    for (uint8_t bank = 0; bank < BANKS; bank++) {
        uint16_t sequence;
        if (is_valid(node, bank, &sequence, &failed) &&
            ((node->store.bank == ODS_NONE) || ((int16_t)(uint16_t)(sequence - node->store.sequence) > 0))) {
            node->store.bank = bank;
            node->store.sequence = sequence;
        }
    }
    return failed ? ODS_ABORT_HARDWARE : 0u;
}

/* Groups that the record in force holds values of. */
static uint32_t stored_groups(const ods_node_t *node, uint32_t owner, int *failed)
{
    tape_t tape = tape_at(node, bank_address(node->device, node->store.bank) + HEADER + (2u * owner));
    const uint32_t groups = (node->store.bank == ODS_NONE) ? 0u : read_number(&tape, 2);
    *failed |= tape.failed;
    return tape.failed ? 0u : groups;
}

static int is_communication(const ods_od_t *od, uint32_t instance, uint32_t entry)
{
    return (instance >= od->scope_instances[ODS_SCOPE_RPDO]) || (entry < od->communication_entries);
}

static void load_value(ods_node_t *node, tape_t *tape, const ods_od_ref_t *ref, int wanted)
{
    const ods_od_t *const od = node->od;
    const ods_od_rule_t *const rule = &od->rules[ref->entry->rule];
    const uint32_t size = ods_od_room(od, ref->entry);
    const int is_plain = ods_od_is_number(ref->entry->kind) && !ods_od_is_long(ref->entry->kind);

    if (is_plain) {
        const uint32_t number = read_number(tape, size);
        const int in_range = (ods_od_check(od, ref->entry, rule, number) == 0u);
        if (wanted && in_range && !tape->failed) {
            ods_od_set_number(od, node->values, ref->entry, ref->instance, number);
        }
        return;
    }
    for (uint32_t n = 0; n < size; n++) {
        node->buffer[n] = read_octet(tape);
    }
    if (wanted && !tape->failed) {
        ods_od_set_octets(od, node->values, ref, node->buffer, (uint16_t)size);
    }
}

void ods_store_load(ods_node_t *node, int communication_only)
{
    const ods_od_t *const od = node->od;
    (void)find_record(node); /* what cannot be read is not in force */
    if (node->store.bank == ODS_NONE) {
        return;
    }
    tape_t tape = tape_at(node, bank_address(node->device, node->store.bank) + HEADER + (2u * owners(node->device)));
    for (uint32_t instance = 0; instance < od->scope_instances[ODS_SCOPES]; instance++) {
        const uint32_t scope = scope_of(od, instance);
        const uint32_t stored = stored_groups(node, owner_of(od, instance), &tape.failed);
        for (uint32_t n = od->scope_entries[scope]; n < od->scope_entries[scope + 1u]; n++) {
            const ods_od_ref_t ref = { &od->entries[n], instance };
            const uint32_t group = group_of(od, ref.entry);
            const int wanted = !communication_only || is_communication(od, instance, n);
            if (group != 0u) {
                load_value(node, &tape, &ref, wanted && ((stored & group) != 0u));
            }
        }
    }
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

/* What the new record has to hold: the groups of `row` are taken from the values, or left out. */
typedef struct {
    const ods_store_row_t *row;
    int save;
} change_t;

/* The groups of an owner that the change concerns. */
static uint32_t concerned(const change_t *change, uint32_t owner)
{
    const int all = change->row->axis == ODS_ALL_AXES;
    return (all || (owner == 1u + (uint32_t)change->row->axis)) ? change->row->groups : 0u;
}

static uint32_t new_groups(
    const ods_node_t *node, const change_t *change, uint32_t owner, uint32_t owned, int *failed)
{
    const uint32_t stored = stored_groups(node, owner, failed);
    const uint32_t groups = concerned(change, owner) & owned;
    return change->save ? (stored | groups) : (stored & ~groups);
}

/* Groups that an owner has values of: others cannot be stored. */
static uint32_t owned_groups(const ods_od_t *od, uint32_t owner)
{
    uint32_t groups = 0;
    for (uint32_t scope = 0; scope < (uint32_t)ODS_SCOPES; scope++) {
        if ((scope == (uint32_t)ODS_SCOPE_AXIS) != (owner != DEVICE_OWNER)) {
            continue;
        }
        for (uint32_t n = od->scope_entries[scope]; n < od->scope_entries[scope + 1u]; n++) {
            groups |= group_of(od, &od->entries[n]);
        }
    }
    return groups;
}

/* One value of the new record: the present one, that of the old record, or zeros. */
static void write_value(ods_node_t *node, tape_t *to, tape_t *from, const ods_od_ref_t *ref, int fresh, int kept)
{
    const uint32_t size = ods_od_room(node->od, ref->entry);
    uint8_t number[8];
    uint16_t length = 0;
    const uint8_t *const octets = ods_od_octets(node->od, node->values, ref, number, &length);
    for (uint32_t n = 0; n < size; n++) {
        const uint8_t old = (node->store.bank == ODS_NONE) ? 0u : read_octet(from);
        const uint8_t present = (n < length) ? octets[n] : 0u;
        write_octet(to, fresh ? present : (kept ? old : 0u));
    }
}

static void write_values(ods_node_t *node, tape_t *to, const change_t *change)
{
    const ods_od_t *const od = node->od;
    const uint32_t old_bank = (node->store.bank == ODS_NONE) ? 0u : node->store.bank;
    tape_t from = tape_at(node, bank_address(node->device, old_bank) + HEADER + (2u * owners(node->device)));
    for (uint32_t instance = 0; instance < od->scope_instances[ODS_SCOPES]; instance++) {
        const uint32_t scope = scope_of(od, instance);
        const uint32_t owner = owner_of(od, instance);
        const uint32_t stored = stored_groups(node, owner, &from.failed);
        const uint32_t groups = concerned(change, owner);
        for (uint32_t n = od->scope_entries[scope]; n < od->scope_entries[scope + 1u]; n++) {
            const ods_od_ref_t ref = { &od->entries[n], instance };
            const uint32_t group = group_of(od, ref.entry);
            const int is_concerned = (groups & group) != 0u;
            if (group != 0u) {
                write_value(
                    node, to, &from, &ref, is_concerned && change->save, !is_concerned && ((stored & group) != 0u));
            }
        }
    }
    to->failed |= from.failed;
}

/* Whether the record in force cannot be read any more. A new one, which takes over parts of it, is not even begun. */
static int is_lost(const ods_node_t *node, uint32_t size)
{
    tape_t tape = tape_at(node, bank_address(node->device, node->store.bank) + HEADER);
    for (uint32_t n = 0; (node->store.bank != ODS_NONE) && (n < size); n++) {
        (void)read_octet(&tape);
    }
    return tape.failed;
}

static uint32_t write_record(ods_node_t *node, const change_t *change)
{
    const uint32_t size = payload_size(node->device);
    const uint8_t bank = (node->store.bank == 0u) ? 1u : 0u;
    const uint16_t sequence = (uint16_t)(node->store.sequence + 1u);
    const uint32_t at = bank_address(node->device, bank);
    const uint32_t head[3] = { node->od->layout, sequence, size };
    const uint32_t octets[3] = { 4, 2, 2 };
    tape_t payload = tape_at(node, at + HEADER);
    tape_t header = tape_at(node, at);

    if (is_lost(node, size)) {
        return ODS_ABORT_HARDWARE;
    }
    for (uint32_t field = 0; field < 3u; field++) {
        for (uint32_t n = 0; n < octets[field]; n++) {
            payload.crc = crc_32(payload.crc, (uint8_t)(head[field] >> (8u * n)));
        }
    }
    for (uint32_t owner = 0; owner < owners(node->device); owner++) {
        write_number(&payload, new_groups(node, change, owner, owned_groups(node->od, owner), &payload.failed), 2);
    }
    write_values(node, &payload, change);
    header.failed = payload.failed;
    for (uint32_t field = 0; field < 3u; field++) {
        write_number(&header, head[field], octets[field]);
    }
    write_number(&header, ~payload.crc, 4);
    if (header.failed) {
        return ODS_ABORT_HARDWARE;
    }
    node->store.bank = bank;
    node->store.sequence = sequence;
    return 0;
}

/* Rows with the effect of storing and of restoring stand in one table; an entry without a row has no groups. */
static uint32_t change_record(ods_node_t *node, uint16_t index, uint8_t sub, int save)
{
    for (uint32_t n = 0; n < node->device->store_count; n++) {
        const ods_store_row_t *const row = &node->device->stores[n];
        const change_t change = { row, save };
        if ((row->index != index) || (row->sub != sub)) {
            continue;
        }
        if (node->store.bank == ODS_NONE) { /* perhaps it could not be read before */
            const uint32_t abort = find_record(node);
            if (abort != 0u) {
                return abort;
            }
        }
        /* Without a record the defaults are in force already. */
        return (save || (node->store.bank != ODS_NONE)) ? write_record(node, &change) : 0u;
    }
    return 0;
}

uint32_t ods_store_save(ods_node_t *node, uint16_t index, uint8_t sub)
{
    return change_record(node, index, sub, 1);
}

uint32_t ods_store_restore(ods_node_t *node, uint16_t index, uint8_t sub)
{
    return change_record(node, index, sub, 0);
}
