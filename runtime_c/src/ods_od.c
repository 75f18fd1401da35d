#include "ods_od.h"

#include <string.h>

uint32_t ods_od_find(const ods_od_t *od, uint16_t index, uint8_t sub, ods_od_ref_t *ref)
{
    ods_od_ref_t found;
    const uint32_t abort = ods_od_locate(od, index, sub, &found);
    if (abort != 0u) {
        return abort;
    }
    if (found.entry->kind == 0u) {
        return ODS_ABORT_NO_SUB_INDEX;
    }
    *ref = found;
    return 0;
}

uint16_t ods_od_room(const ods_od_t *od, const ods_od_entry_t *entry)
{
    return ods_od_is_number(entry->kind) ? (uint16_t)ods_od_number_size(entry->kind) : od->texts[entry->at].length;
}

/* The two words of a number of 8 octets, the low one first, whatever the order of octets in memory. */
static void long_number(const ods_od_t *od, uint8_t *values, const ods_od_ref_t *ref, uint8_t number[8])
{
    uint64_t value;
    if ((ref->entry->kind & ODS_CONST) != 0u) {
        const uint32_t *const words = &od->words[ref->entry->at];
        value = words[0] | (uint64_t)words[1] << 32;
    } else {
        memcpy(&value, ods_od_value(od, values, ref->entry, ref->instance), sizeof value);
    }
    for (uint32_t n = 0; n < 8u; n++) {
        number[n] = (uint8_t)(value >> (8u * n));
    }
}

static void set_long_number(const ods_od_t *od, uint8_t *values, const ods_od_ref_t *ref, const uint8_t *octets)
{
    uint64_t value = 0;
    for (uint32_t n = 0; n < 8u; n++) {
        value |= (uint64_t)octets[n] << (8u * n);
    }
    memcpy(ods_od_value(od, values, ref->entry, ref->instance), &value, sizeof value);
}

const uint8_t *ods_od_octets(
    const ods_od_t *od, uint8_t *values, const ods_od_ref_t *ref, uint8_t number[8], uint16_t *length)
{
    const uint32_t kind = ref->entry->kind;
    if (!ods_od_is_number(kind)) {
        const ods_od_text_t *const text = &od->texts[ref->entry->at];
        *length = text->length;
        if (text->octets != NULL) {
            return (const uint8_t *)text->octets;
        }
        const uint8_t *const octets = values + od->bases[ref->instance] + text->at;
        if ((kind & ODS_TYPE_MASK) == ODS_VISIBLE_STRING) {
            const void *const end = memchr(octets, 0, text->length);
            *length = (end == NULL) ? text->length : (uint16_t)((const uint8_t *)end - octets);
        }
        return octets;
    }
    *length = (uint16_t)ods_od_number_size(kind);
    if (ods_od_is_long(kind)) {
        long_number(od, values, ref, number);
    } else {
        const uint32_t value = ods_od_number(od, values, ref);
        for (uint32_t n = 0; n < 4u; n++) {
            number[n] = (uint8_t)(value >> (8u * n));
        }
    }
    return number;
}

void ods_od_set_octets(
    const ods_od_t *od, uint8_t *values, const ods_od_ref_t *ref, const uint8_t *octets, uint16_t length)
{
    if (!ods_od_is_number(ref->entry->kind)) {
        const ods_od_text_t *const text = &od->texts[ref->entry->at];
        if (text->octets == NULL) {
            uint8_t *const place = values + od->bases[ref->instance] + text->at;
            memcpy(place, octets, length);
            memset(place + length, 0, (size_t)text->length - length);
        }
    } else if ((ref->entry->kind & ODS_CONST) == 0u) {
        set_long_number(od, values, ref, octets);
    }
}

uint32_t ods_od_check(const ods_od_t *od, const ods_od_entry_t *entry, const ods_od_rule_t *rule, uint32_t number)
{
    const ods_od_interval_t *interval = &od->intervals[rule->first];
    uint32_t value = number;

    if (ODS_OD_IS_SIGNED(entry->kind)) {
        const uint32_t sign = 0x80u << (8u * (ods_od_number_size(entry->kind) - 1u));
        value = ODS_OD_BIAS((value ^ sign) - sign);
    }
    if ((rule->flags & ODS_OD_RANGE) != 0u) {
        if (value < interval->low) {
            return ODS_ABORT_VALUE_TOO_LOW;
        }
        return (value > interval->high) ? ODS_ABORT_VALUE_TOO_HIGH : 0u;
    }
    if (rule->intervals == 0u) {
        return 0;
    }
    for (uint32_t n = 0; n < rule->intervals; n++, interval++) {
        if ((value >= interval->low) && (value <= interval->high)) {
            return 0;
        }
    }
    return ((rule->flags & ODS_OD_SIGNATURE) != 0u) ? ODS_ABORT_NOT_STORED : ODS_ABORT_INVALID_VALUE;
}

/* Map the objects of another axis: those that lie in an area of the axes. */
static void move_mapping(const ods_od_t *od, uint32_t *mapping, uint32_t axis)
{
    for (uint32_t n = 0; n < od->max_mapped; n++) {
        for (uint32_t area = 0; area < od->area_count; area++) {
            const uint32_t index = mapping[n] >> 16;
            if ((index >= od->areas[area].first) && (index <= od->areas[area].last)) {
                mapping[n] += (axis * od->areas[area].stride) << 16;
                break;
            }
        }
    }
}

static void pdo_defaults(
    const ods_od_t *od, uint8_t *values, ods_scope_t scope, uint32_t each, const uint32_t *other_cob_ids)
{
    const uint32_t size = od->scope_size[scope];
    const uint32_t first = od->scope_instances[scope];
    const uint32_t count = od->scope_instances[scope + 1] - first;

    for (uint32_t n = 0; n < count; n++) {
        const uint32_t axis = n / each;
        const uint32_t number = n % each;
        void *const instance = ods_od_instance(od, values, first + n);
        ods_pdo_values_t *const pdo = (ods_pdo_values_t *)instance;
        memcpy(instance, (const uint8_t *)od->defaults[scope] + (number * size), size);
        if (axis > 0u) {
            pdo->pdo_cob_id = other_cob_ids[number];
            move_mapping(od, ods_pdo_mapping(pdo), axis);
        }
    }
}

/* Whether an entry has memory, and where in the struct of its instance. */
static int has_memory(const ods_od_t *od, const ods_od_entry_t *entry, uint32_t *at)
{
    if ((entry->kind == 0u) || ((entry->kind & ODS_CONST) != 0u)) {
        return 0;
    }
    *at = ods_od_is_number(entry->kind) ? entry->at : od->texts[entry->at].at;
    return 1;
}

/* Values of the device in 1000h to 1FFFh; what else lies in its struct stays. */
static void communication_defaults(const ods_od_t *od, uint8_t *values)
{
    const uint8_t *const defaults = (const uint8_t *)od->defaults[ODS_SCOPE_DEVICE];
    uint32_t at;

    for (uint32_t n = 0; n < od->communication_entries; n++) {
        if (has_memory(od, &od->entries[n], &at)) {
            memcpy(values + od->bases[0] + at, defaults + at, ods_od_room(od, &od->entries[n]));
        }
    }
}

/* Whether an offset into the block is that of a value that ods_od_defaults() has just set. */
static int is_communication(const ods_od_t *od, uint32_t offset)
{
    uint32_t at;

    if ((od->scope_instances[ODS_SCOPE_RPDO] < od->scope_instances[ODS_SCOPES]) &&
        (offset >= od->bases[od->scope_instances[ODS_SCOPE_RPDO]])) {
        return 1;
    }
    for (uint32_t n = 0; n < od->communication_entries; n++) {
        if (has_memory(od, &od->entries[n], &at) && (od->bases[0] + at == offset)) {
            return 1;
        }
    }
    return 0;
}

void ods_od_defaults(const ods_od_t *od, uint8_t *values, uint8_t node_id, int communication_only)
{
    if (communication_only) {
        communication_defaults(od, values);
    } else {
        memcpy(values + od->bases[0], od->defaults[ODS_SCOPE_DEVICE], od->scope_size[ODS_SCOPE_DEVICE]);
        for (uint32_t n = od->scope_instances[ODS_SCOPE_AXIS]; n < od->scope_instances[ODS_SCOPE_RPDO]; n++) {
            memcpy(values + od->bases[n], od->defaults[ODS_SCOPE_AXIS], od->scope_size[ODS_SCOPE_AXIS]);
        }
    }
    pdo_defaults(od, values, ODS_SCOPE_RPDO, od->axis_rpdos, od->other_cob_ids);
    pdo_defaults(
        od,
        values,
        ODS_SCOPE_TPDO,
        od->axis_tpdos,
        (od->other_cob_ids == NULL) ? NULL : od->other_cob_ids + od->axis_rpdos);
    for (uint32_t n = 0; n < od->node_id_count; n++) {
        const ods_od_node_id_t *const row = &od->node_ids[n];
        uint8_t *const value = values + row->at;
        if (communication_only && !is_communication(od, row->at)) {
            continue;
        }
        switch (row->kind & 3u) {
        case 0:
            *value = (uint8_t)(*value + node_id);
            break;
        case 1:
            *(uint16_t *)(void *)value = (uint16_t)(*(uint16_t *)(void *)value + node_id);
            break;
        default:
            *(uint32_t *)(void *)value += node_id;
            break;
        }
    }
}
