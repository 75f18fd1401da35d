/*
 * Asks a dictionary for all 2^24 addresses and prints what answers, one line each:
 *
 *     INDEX:SUB type access mapping default intervals flags states group effect instance
 *
 * The values are those after power-on with node-ID 5, in a block that is exactly as large as the tables say, so that a
 * sanitizer sees every access beside it. It fails where tables that lead to entries contradict these.
 * Compile with -DDEVICE_HEADER='"x_device.h"' -DDEVICE=x_device -DVALUES=x_values_t.
 */
#include DEVICE_HEADER

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NODE_ID 5u

static const ods_od_t *od;
static uint8_t *values;

static uint8_t *instance_at(uint32_t instance)
{
    return (uint8_t *)ods_od_instance(od, values, (uint16_t)instance);
}

static uint32_t size_of(const ods_od_entry_t *entry)
{
    const uint32_t type = entry->kind & ODS_TYPE_MASK;
    return (type < ODS_U8) ? od->texts[entry->at].length : (1u << (type & 3u));
}

static uint64_t load(const uint8_t *from, uint32_t size)
{
    uint64_t value = 0;
    switch (size) {
    case 1:
        return *from;
    case 2: {
        uint16_t word;
        memcpy(&word, from, sizeof word);
        return word;
    }
    case 4: {
        uint32_t word;
        memcpy(&word, from, sizeof word);
        return word;
    }
    default:
        memcpy(&value, from, sizeof value);
        return value;
    }
}

/* ---- power-on, as ods/od.h describes it ------------------------------------------------------------------------ */

static void move_mapping(ods_pdo_values_t *pdo, uint32_t axis)
{
    uint32_t *const mapping = ods_pdo_mapping(pdo);
    for (uint32_t n = 0; n < od->max_mapped; n++) {
        const uint32_t index = mapping[n] >> 16;
        for (uint32_t a = 0; a < od->area_count; a++) {
            if ((index >= od->areas[a].first) && (index <= od->areas[a].last)) {
                mapping[n] += (axis * od->areas[a].stride) << 16;
            }
        }
    }
}

static void power_on_pdos(ods_scope_t scope, uint32_t each, uint32_t first_other)
{
    const uint32_t first = od->scope_instances[scope];
    const uint32_t count = od->scope_instances[scope + 1] - first;
    const uint8_t *const defaults = (const uint8_t *)od->defaults[scope];
    for (uint32_t n = 0; n < count; n++) {
        uint8_t *const at = instance_at(first + n);
        memcpy(at, defaults + (n % each) * od->scope_size[scope], od->scope_size[scope]);
        if (n >= each) {
            ods_pdo_values_t *const pdo = (ods_pdo_values_t *)(void *)at;
            pdo->pdo_cob_id = od->other_cob_ids[first_other + (n % each)];
            move_mapping(pdo, n / each);
        }
    }
}

static void power_on(void)
{
    memset(values, 0xA5, od->values_size);
    for (uint32_t scope = ODS_SCOPE_DEVICE; scope <= ODS_SCOPE_AXIS; scope++) {
        for (uint32_t n = od->scope_instances[scope]; n < od->scope_instances[scope + 1]; n++) {
            memcpy(instance_at(n), od->defaults[scope], od->scope_size[scope]);
        }
    }
    power_on_pdos(ODS_SCOPE_RPDO, od->axis_rpdos, 0);
    power_on_pdos(ODS_SCOPE_TPDO, od->axis_tpdos, od->axis_rpdos);
    for (uint32_t n = 0; n < od->node_id_count; n++) {
        uint8_t *const at = values + od->node_ids[n].at;
        const uint32_t size = 1u << (od->node_ids[n].kind & 3u);
        const uint64_t sum = load(at, size) + NODE_ID;
        for (uint32_t octet = 0; octet < size; octet++) {
            at[octet] = (uint8_t)(sum >> (8u * octet)); /* the hosts that run this test are little-endian */
        }
    }
}

/* ---- printing ---------------------------------------------------------------------------------------------------- */

static void print_value(const ods_od_ref_t *ref)
{
    const ods_od_entry_t *const entry = ref->entry;
    const uint32_t type = entry->kind & ODS_TYPE_MASK;
    const uint32_t size = size_of(entry);
    const uint8_t *const instance = instance_at(ref->instance);
    uint64_t value;

    if (type < ODS_U8) {
        const ods_od_text_t *const text = &od->texts[entry->at];
        const uint8_t *const octets = (text->octets != NULL) ? (const uint8_t *)text->octets : instance + text->at;
        printf(" x");
        for (uint32_t n = 0; n < size; n++) {
            printf("%02x", octets[n]);
        }
        return;
    }
    if ((entry->kind & ODS_CONST) == 0u) {
        value = load(instance + entry->at, size);
    } else if (size <= 2u) {
        value = entry->at;
    } else {
        value = od->words[entry->at];
        if (size == 8u) {
            value |= (uint64_t)od->words[entry->at + 1u] << 32;
        }
    }
    printf(" %" PRIu64, value);
}

static void print_intervals(const ods_od_entry_t *entry, const ods_od_rule_t *rule)
{
    const uint32_t bias = ODS_OD_IS_SIGNED(entry->kind) ? 0x80000000u : 0u;
    printf(" %s", (rule->intervals == 0u) ? "any" : "");
    for (uint32_t n = 0; n < rule->intervals; n++) {
        const ods_od_interval_t *const interval = &od->intervals[rule->first + n];
        const uint32_t low = interval->low ^ bias;
        const uint32_t high = interval->high ^ bias;
        if (bias != 0u) {
            printf("%s%" PRId32 "..%" PRId32, (n != 0u) ? "," : "", (int32_t)low, (int32_t)high);
        } else {
            printf("%s%" PRIu32 "..%" PRIu32, (n != 0u) ? "," : "", low, high);
        }
    }
}

static void print_entry(uint32_t index, uint32_t sub, const ods_od_ref_t *ref)
{
    static const char *const types[] = {
        "-", "VISIBLE_STRING", "OCTET_STRING", "DOMAIN", "UNSIGNED8", "UNSIGNED16", "UNSIGNED32", "UNSIGNED64", /* 0 */
        "INTEGER8", "INTEGER16", "INTEGER32", "INTEGER64", "BOOLEAN", "-", "REAL32", "REAL64", /* 8 */
    };
    static const char *const mappings[] = { "no", "rx", "tx", "both" };
    const ods_od_entry_t *const entry = ref->entry;
    const ods_od_rule_t *const rule = &od->rules[entry->rule];
    const int readable = (entry->kind & ODS_READ) != 0u;

    printf("%04" PRIX32 ":%02" PRIX32 " %s", index, sub, types[entry->kind & ODS_TYPE_MASK]);
    printf(" %s", (entry->rule == 0u) ? (readable ? "ro" : "-") : (readable ? "rw" : "wo"));
    printf(" %s", mappings[(entry->kind >> 5) & 3u]);
    print_value(ref);
    if (entry->rule == 0u) {
        printf(" - - - - -");
    } else {
        print_intervals(entry, rule);
        printf(" %u %u %u %u", rule->flags, rule->states, rule->group, rule->effect);
    }
    printf(" %u\n", ref->instance);
}

/* ---- what other tables say of entries ---------------------------------------------------------------------------- */

/* A string says twice whether it is constant. */
static int is_as_constant_as_its_text(const ods_od_entry_t *entry)
{
    const int is_constant = (entry->kind & ODS_CONST) != 0u;
    return ((entry->kind & ODS_TYPE_MASK) >= ODS_U8) || (is_constant == (od->texts[entry->at].octets != NULL));
}

static int is_in_its_scope(const ods_od_ref_t *ref)
{
    const uint32_t entry = (uint32_t)(ref->entry - od->entries);
    uint32_t scope = 0;
    while (ref->instance >= od->scope_instances[scope + 1u]) {
        scope++;
    }
    return (entry >= od->scope_entries[scope]) && (entry < od->scope_entries[scope + 1u]);
}

/* Whether a value that the node-ID is added to is that of an entry, of the same kind. */
static int is_of_an_entry(const ods_od_node_id_t *row)
{
    for (uint32_t scope = 0; scope < ODS_SCOPES; scope++) {
        for (uint32_t instance = od->scope_instances[scope]; instance < od->scope_instances[scope + 1u]; instance++) {
            for (uint32_t n = od->scope_entries[scope]; n < od->scope_entries[scope + 1u]; n++) {
                const ods_od_entry_t *const entry = &od->entries[n];
                if (((entry->kind & ODS_CONST) == 0u) && (od->bases[instance] + entry->at == row->at) &&
                    ((entry->kind & ODS_TYPE_MASK) == row->kind)) {
                    return 1;
                }
            }
        }
    }
    return 0;
}

/* Returns 0 if nothing contradicts the entries. */
static int compare_tables(void)
{
    int wrong = (od->values_size != sizeof(VALUES));
    for (uint32_t n = 0; n < od->node_id_count; n++) {
        wrong |= !is_of_an_entry(&od->node_ids[n]);
    }
    return wrong;
}

/* ---- asking ------------------------------------------------------------------------------------------------------ */

/* Prints what is there at an index. Returns 0 if what is not there was refused with the right code. */
static int print_object(uint32_t index)
{
    uint32_t answers = 0;
    uint32_t no_object = 0;
    uint32_t no_sub_index = 0;

    for (uint32_t sub = 0; sub <= 0xFFu; sub++) {
        ods_od_ref_t ref = { NULL, 0xFFFFu };
        const uint32_t abort_code = ods_od_find(od, (uint16_t)index, (uint8_t)sub, &ref);
        if (abort_code == 0u) {
            answers++;
            if (!is_in_its_scope(&ref) || !is_as_constant_as_its_text(ref.entry)) {
                return 1;
            }
            print_entry(index, sub, &ref);
        } else {
            no_object += (abort_code == ODS_ABORT_NO_OBJECT) ? 1u : 0u;
            no_sub_index += (abort_code == ODS_ABORT_NO_SUB_INDEX) ? 1u : 0u;
            if ((ref.entry != NULL) || (ref.instance != 0xFFFFu)) {
                return 1;
            }
        }
    }
    return (answers == 0u) ? (no_object != 256u) : (answers + no_sub_index != 256u);
}

int main(void)
{
    int wrong;

    od = DEVICE.od;
    values = malloc(od->values_size);
    if (values == NULL) {
        return 1;
    }
    power_on();
    wrong = compare_tables();
    for (uint32_t index = 0; index <= 0xFFFFu; index++) {
        wrong |= print_object(index);
    }
    free(values);
    return wrong;
}
