/*
 * Values of the dictionary: reading and writing them by their entry, their defaults, and the check of their range.
 * ods/od.h says how the tables are read.
 */
#ifndef ODS_OD_VALUES_H
#define ODS_OD_VALUES_H

#include "ods/od.h"

/* ods_od_locate() in a page of PDO parameters: all PDOs of a direction have the same object, so there is no map. */
static inline uint32_t ods_od_locate_pdo(
    const ods_od_t *od, const ods_od_fold_t *fold, uint32_t low, uint32_t sub, ods_od_ref_t *ref)
{
    const uint32_t group = low >> fold->shift;
    const uint32_t pdo = low - (group << fold->shift);
    if ((group >= fold->groups) || (pdo >= fold->each)) {
        return ODS_ABORT_NO_OBJECT;
    }
    if (sub >= fold->subs) {
        return ODS_ABORT_NO_SUB_INDEX;
    }
    ref->entry = &od->entries[fold->entry + sub];
    ref->instance = fold->first + (group * fold->each) + pdo;
    return 0;
}

/*
 * The same as ods_od_find(), but a hole is found as well: its `kind` is 0, so it can neither be read nor written. For
 * who looks at `kind` anyway. `index` and `sub` are those of a frame, 16 and 8 bits.
 */
static inline uint32_t ods_od_locate(const ods_od_t *od, uint32_t index, uint32_t sub, ods_od_ref_t *ref)
{
    const uint32_t page = index >> 9;
    uint32_t instance = od->owners[page];

    if (instance >= ODS_OD_FOLDED) {
        const ods_od_fold_t *const fold = &od->folds[instance & (ODS_OD_FOLDED - 1u)];
        if (fold->each != 0u) {
            return ods_od_locate_pdo(od, fold, index & 0x1FFu, sub, ref);
        }
        instance = fold->first + ((index & 0x1FFu) >> fold->shift);
    }
    const uint8_t *const map = &od->maps[(uint32_t)od->map_of[page] << 2];
    const ods_od_chunk_t *const chunk = &od->chunks[map[(index >> 4) & 31u]];
    const size_t place = index & 15u;
    const uint32_t number = chunk->first[place] + sub;
    if (number >= chunk->first[place + 1u]) {
        return (chunk->first[place] == chunk->first[place + 1u]) ? ODS_ABORT_NO_OBJECT : ODS_ABORT_NO_SUB_INDEX;
    }
    ref->entry = &od->entries[chunk->entry + number];
    ref->instance = instance;
    return 0;
}

/* Whether the type is a number; else it is a string or a domain. */
static inline int ods_od_is_number(uint32_t kind)
{
    return (kind & ODS_TYPE_MASK) >= ODS_U8;
}

/* Octets of a number. */
static inline uint32_t ods_od_number_size(uint32_t kind)
{
    return 1u << (kind & 3u);
}

/* Whether a number has 8 octets; the functions for numbers below do not take it. */
static inline int ods_od_is_long(uint32_t kind)
{
    return (kind & 3u) == 3u;
}

/* Whether it is a number of up to 4 octets. */
static inline int ods_od_is_short(uint32_t kind)
{
    return ods_od_is_number(kind) && !ods_od_is_long(kind);
}

static inline void *ods_od_value(
    const ods_od_t *od, uint8_t *values, const ods_od_entry_t *entry, uint32_t instance)
{
    return values + od->bases[instance] + entry->at;
}

/* The bits of a number of up to 4 octets, those above being 0. */
static inline uint32_t ods_od_number(const ods_od_t *od, uint8_t *values, const ods_od_ref_t *ref)
{
    const uint32_t kind = ref->entry->kind;
    const uint32_t size = kind & 3u;
    if ((kind & ODS_CONST) != 0u) {
        return (size == 2u) ? od->words[ref->entry->at] : ref->entry->at;
    }
    const void *const value = ods_od_value(od, values, ref->entry, ref->instance);
    if (size == 2u) {
        return *(const uint32_t *)value;
    }
    return (size == 0u) ? *(const uint8_t *)value : *(const uint16_t *)value;
}

/* Put a number of up to 4 octets in place. Constants stay what they are. */
static inline void ods_od_set_number(
    const ods_od_t *od, uint8_t *values, const ods_od_entry_t *entry, uint32_t instance, uint32_t number)
{
    const uint32_t kind = entry->kind;
    const uint32_t size = kind & 3u;
    if ((kind & ODS_CONST) != 0u) {
        return;
    }
    void *const value = ods_od_value(od, values, entry, instance);
    if (size == 2u) {
        *(uint32_t *)value = number;
    } else if (size == 0u) {
        *(uint8_t *)value = (uint8_t)number;
    } else {
        *(uint16_t *)value = (uint16_t)number;
    }
}

/* Octets that an entry can have: of a string in memory the most that fit. */
uint16_t ods_od_room(const ods_od_t *od, const ods_od_entry_t *entry);

/*
 * The octets of an entry as they go over the bus. A string or domain stands where the result points to; a number is
 * written into `number` first. `length` becomes their number.
 */
const uint8_t *ods_od_octets(
    const ods_od_t *od, uint8_t *values, const ods_od_ref_t *ref, uint8_t number[8], uint16_t *length);

/* Put octets of anything but a short number in place, as many as the entry takes: a shorter text ends with a 0. */
void ods_od_set_octets(
    const ods_od_t *od, uint8_t *values, const ods_od_ref_t *ref, const uint8_t *octets, uint16_t length);

/* A number of up to 4 octets without the bits above those of its type. */
static inline uint32_t ods_od_cut(uint32_t kind, uint32_t number)
{
    const uint32_t unused = 32u - (8u << (kind & 3u));
    return number << unused >> unused;
}

/* Whether a rule allows a number of up to 4 octets: 0 or the abort code that says why not. */
uint32_t ods_od_check(const ods_od_t *od, const ods_od_entry_t *entry, const ods_od_rule_t *rule, uint32_t number);

/* All values, or those of 1000h to 1FFFh alone, as the specification has them at power-on under a node-ID. */
void ods_od_defaults(const ods_od_t *od, uint8_t *values, uint8_t node_id, int communication_only);

#endif
