/*
 * The object dictionary of a device: its tables, and the way from an address on the bus to a row of them.
 *
 * A device has one constant `ods_od_t`, made by the generator. All tables stay in flash; what changes lives in one
 * block of memory, the device's values, which the caller provides. Nothing here depends on a particular device.
 *
 * Instances
 *     The values are a row of structs, the instances: number 0 is that of the device, then follow those of the axes,
 *     of the RPDOs and of the TPDOs. The structs of one scope are alike. Each begins with the struct that the runtime
 *     knows (ods/values.h); behind it stand the fields that only the device's own objects need. `bases` tells where in
 *     the block an instance begins.
 *
 * Folding
 *     The tables describe an axis once and a PDO once. An index is split into an instance and the place of the object
 *     in the folded dictionary, by table alone: no search, no division, the same time for each index.
 *
 *         page  = index / 512                     owners[page]: the instance, or ODS_OD_FOLDED + the number of a fold
 *         map   = &maps[map_of[page] * 4]         for each 16 indices of the page the number of their chunk
 *         chunk = &chunks[map[index % 512 / 16]]  where the entries of its objects begin, equal where there is none
 *         entry = &entries[chunk->entry + chunk->first[index % 16] + sub]
 *
 *     A page that several instances share has a fold, which takes the instance from the index and leaves an index of
 *     the first instance. PDO parameters are folded twice, over the axes and over the PDOs of an axis.
 *     Map 0 and chunk 0 are empty. There is a row for every sub-index up to the highest one; that of a hole has
 *     kind 0.
 *
 * Entries
 *     `kind` has the type in its low half and four flags. An entry can be written if it has a `rule` (not 0).
 *     What `at` means depends on them:
 *         variable              offset in the struct of its instance
 *         constant, <= 16 bits  the value itself
 *         constant, more bits   number of its first word in `words`, the low word first
 *         string or domain      number of its row in `texts`, which has octets if it is constant
 *     A constant may be writable, as a command is: the rule is obeyed, the value never kept.
 *
 * Rules
 *     How a write is checked, in this order: the states in which it is allowed (ODS_ABORT_DEVICE_STATE), its value, and
 *     what its effect refuses. A value has to lie in one of the intervals, if there are any; what is refused depends:
 *         ODS_OD_SIGNATURE  signatures that are obeyed: ODS_ABORT_NOT_STORED
 *         ODS_OD_LISTED     a set: ODS_ABORT_INVALID_VALUE
 *         ODS_OD_RANGE      one interval, a range: ODS_ABORT_VALUE_TOO_HIGH or ODS_ABORT_VALUE_TOO_LOW
 *     Limits of signed types are biased, so that one unsigned comparison of the biased value does for all.
 *
 * Strings
 *     A constant is as long as it is. A VISIBLE_STRING in memory ends at its first 0 octet or at its length; an
 *     OCTET_STRING or DOMAIN always has all its octets.
 *
 * Power-on
 *     The defaults are images of the structs, one for each scope; those of PDOs are one for each PDO of an axis.
 *     For PDOs of axes other than the first two things differ: the COB-ID is that of `other_cob_ids`, and a mapped
 *     index that lies in an area of the axes moves up by the area's stride. Then the node-ID is added where
 *     `node_ids` says so.
 */
#ifndef ODS_OD_H
#define ODS_OD_H

#include <stddef.h>
#include <stdint.h>

#include "ods/values.h"
#include "ods/vocabulary.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whose values an object holds. Entries and instances are sorted by scope. */
typedef enum {
    ODS_SCOPE_DEVICE,
    ODS_SCOPE_AXIS,
    ODS_SCOPE_RPDO,
    ODS_SCOPE_TPDO,
    ODS_SCOPES
} ods_scope_t;

/* Fails to compile where the condition is false. */
#define ODS_STATIC_ASSERT(name, condition) typedef char name[(condition) ? 1 : -1]

/* Offset of a member as the tables hold it. */
#define ODS_OD_AT(type, member) ((uint16_t)offsetof(type, member))

#define ODS_OD_PAGES 128u
#define ODS_OD_FOLDED 0x80u

/*
 * Types, the low half of `kind`. From ODS_U8 on they are numbers, bits 1..0 being the binary logarithm of their size in
 * octets; 0 is a hole. A BOOLEAN counts as unsigned.
 */
#define ODS_VISIBLE_STRING 0x01u
#define ODS_OCTET_STRING 0x02u
#define ODS_DOMAIN 0x03u
#define ODS_U8 0x04u
#define ODS_U16 0x05u
#define ODS_U32 0x06u
#define ODS_U64 0x07u
#define ODS_I8 0x08u
#define ODS_I16 0x09u
#define ODS_I32 0x0Au
#define ODS_I64 0x0Bu
#define ODS_BOOL 0x0Cu
#define ODS_REAL32 0x0Eu
#define ODS_REAL64 0x0Fu
#define ODS_TYPE_MASK 0x0Fu
#define ODS_OD_IS_SIGNED(kind) (((kind)&0x0Cu) == ODS_I8)

/* Flags, the high half of `kind`. */
#define ODS_READ 0x10u /* can be read */
#define ODS_RX 0x20u /* an RPDO may carry it */
#define ODS_TX 0x40u /* a TPDO may carry it */
#define ODS_CONST 0x80u /* has no memory */

typedef struct {
    uint16_t at;
    uint8_t kind;
    uint8_t rule;
} ods_od_entry_t;

/* Where the entries of 16 objects begin, counted from `entry`; the last one is the end. */
typedef struct {
    uint16_t entry;
    uint8_t first[17];
} ods_od_chunk_t;

/*
 * A page that several instances share. The upper bits of an index in the page, from `shift` on, are the group.
 *     each = 0  a group is an axis, whose instance is `first` plus the group; the page has a map
 *     each > 0  a group has so many PDOs, told apart by the lower bits. The page holds one object, the same for all of
 *               them, and needs no map: its rows begin at `entry`. Their instances count from `first`.
 */
typedef struct {
    uint16_t entry;
    uint16_t first;
    uint8_t shift;
    uint8_t each;
    uint8_t groups; /* of PDOs */
    uint8_t subs; /* rows of the object of PDOs */
} ods_od_fold_t;

#define ODS_OD_SIGNATURE 0x01u /* the intervals are signatures */
#define ODS_OD_LISTED 0x02u /* the intervals are a set of values */
#define ODS_OD_RANGE 0x04u /* one interval, a range */
#define ODS_OD_GUARDED 0x08u /* states or the effect may speak against a write, too */

typedef struct {
    uint8_t first; /* its first interval */
    uint8_t intervals; /* how many there are; 0: every value of the type may be written */
    uint8_t flags; /* 0: nothing can speak against a write */
    uint8_t states; /* PDS states in which it may be written, bit 1 << ods_pds_state_t; 0: all */
    uint8_t group; /* storage group, counted from 1; 0: never stored */
    uint8_t effect; /* ods_effect_t: what a write does */
} ods_od_rule_t;

/* Limits, both included. */
typedef struct {
    uint32_t low;
    uint32_t high;
} ods_od_interval_t;

#define ODS_OD_BIAS(value) ((uint32_t)(value) ^ 0x80000000u)

/* A string: constant text, or with `octets` NULL a field of the instance. */
typedef struct {
    const char *octets;
    uint16_t at;
    uint16_t length;
} ods_od_text_t;

/* A value, `at` octets into the whole block, to which the node-ID is added. */
typedef struct {
    uint16_t at;
    uint8_t kind;
} ods_od_node_id_t;

/* Indices that repeat per axis: axis n has them at + n * stride. */
typedef struct {
    uint16_t first;
    uint16_t last;
    uint16_t stride;
} ods_od_area_t;

typedef struct {
    const uint8_t *maps;
    const ods_od_chunk_t *chunks;
    const ods_od_entry_t *entries;
    const uint16_t *bases; /* octets from the beginning of the block to each instance */
    const ods_od_rule_t *rules;
    const ods_od_interval_t *intervals;
    const uint32_t *words;
    const ods_od_text_t *texts;
    const ods_od_fold_t *folds;

    const void *defaults[ODS_SCOPES]; /* NULL where there is no instance */
    const uint32_t *other_cob_ids; /* RPDOs, then TPDOs of an axis other than the first; NULL if there is none */
    const ods_od_node_id_t *node_ids;
    const ods_od_area_t *areas;

    uint32_t layout; /* equal only where stored values mean the same */
    uint16_t values_size; /* octets of the whole block */
    uint16_t buffer_size; /* octets of the largest value in the block, at least 8 */
    uint16_t communication_entries; /* entries of the device in 1000h..1FFFh; they are the first ones */
    uint16_t scope_entries[ODS_SCOPES + 1]; /* first entry of each scope, and the end */
    uint16_t scope_instances[ODS_SCOPES + 1]; /* first instance of each scope, and the end */
    uint16_t scope_size[ODS_SCOPES]; /* octets of an instance */
    uint16_t axis_rpdos; /* RPDOs of one axis, or of a device without axes */
    uint16_t axis_tpdos;
    uint16_t node_id_count;
    uint8_t area_count;
    uint8_t max_mapped; /* mapping entries of a PDO */

    uint8_t owners[ODS_OD_PAGES];
    uint8_t map_of[ODS_OD_PAGES];
} ods_od_t;

/* What an address on the bus leads to. */
typedef struct {
    const ods_od_entry_t *entry;
    uint32_t instance;
} ods_od_ref_t;

/*
 * Look an address up. Returns 0, or the SDO abort code that says why there is nothing: ODS_ABORT_NO_OBJECT or
 * ODS_ABORT_NO_SUB_INDEX; what `ref` holds is then of no meaning. Every index and sub-index is safe to ask for.
 */
uint32_t ods_od_find(const ods_od_t *od, uint16_t index, uint8_t sub, ods_od_ref_t *ref);

/* The struct of an instance in a block of values. */
static inline void *ods_od_instance(const ods_od_t *od, void *values, uint32_t instance)
{
    return (uint8_t *)values + od->bases[instance];
}

/* The mapping entries of a PDO, `max_mapped` of them: they stand behind what all devices have in common. */
static inline uint32_t *ods_pdo_mapping(ods_pdo_values_t *pdo)
{
    return (uint32_t *)(void *)((uint8_t *)pdo + sizeof(ods_pdo_values_t));
}

#ifdef __cplusplus
}
#endif

#endif
