#include "invariants.h"

#include <string.h>

/* ---- values ------------------------------------------------------------------------------------------------------ */

static uint32_t number_of(const uint8_t *octets, uint8_t type)
{
    const uint32_t size = 1u << (type & 3u);
    uint32_t bits = 0;
    if (size == 1u) {
        bits = *octets;
    } else if (size == 2u) {
        uint16_t half;
        memcpy(&half, octets, sizeof half);
        bits = half;
    } else {
        memcpy(&bits, octets, sizeof bits);
    }
    if (ODS_OD_IS_SIGNED(type)) {
        const uint32_t sign = 1u << ((8u * size) - 1u);
        bits = (uint32_t)ODS_OD_BIAS((bits ^ sign) - sign);
    }
    return bits;
}

static void check_value(const rig_t *rig, const rig_entry_t *entry)
{
    const ods_od_t *const od = rig->device->od;
    const ods_od_rule_t *const rule = &od->rules[entry->ref.entry->rule];
    const uint8_t type = entry->ref.entry->kind & ODS_TYPE_MASK;
    const uint8_t *const values = rig->memory.values;
    const uint32_t number = number_of(&values[od->bases[entry->ref.instance] + entry->ref.entry->at], type);
    uint32_t allowed = 0;
    for (uint32_t n = 0; n < rule->intervals; n++) {
        const ods_od_interval_t *const interval = &od->intervals[rule->first + n];
        allowed += ((number >= interval->low) && (number <= interval->high)) ? 1u : 0u;
    }
    PROMISE(allowed > 0u);
}

/* Has this entry a number in memory that is kept and that its rule limits? */
static int is_limited(const ods_od_t *od, const ods_od_entry_t *entry)
{
    const uint8_t type = entry->kind & ODS_TYPE_MASK;
    if ((entry->rule == 0u) || (entry->kind & ODS_CONST) || (type < ODS_U8) || ((type & 3u) == 3u)) {
        return 0;
    }
    return (od->rules[entry->rule].intervals > 0u) && ((od->rules[entry->rule].flags & ODS_OD_SIGNATURE) == 0u);
}

/* CAN-IDs that CiA 301 reserves (7.3.5, table 41). */
static int is_restricted(uint32_t id)
{
    return (id <= 0x7Fu) || ((id >= 0x101u) && (id <= 0x180u)) || ((id >= 0x581u) && (id <= 0x5FFu)) ||
           ((id >= 0x601u) && (id <= 0x67Fu)) || ((id >= 0x6E0u) && (id <= 0x7FFu));
}

static void check_cob_id(uint32_t cob_id)
{
    if ((cob_id & 0x80000000u) == 0u) {
        PROMISE((cob_id & 0x3FFFF800u) == 0u);
        PROMISE(!is_restricted(cob_id & 0x7FFu));
    }
}

static void check_pdos(const rig_t *rig)
{
    const ods_node_t *const node = rig->node;
    const ods_pdo_t *const pdos = &node->pdo;
    const ods_od_t *const od = rig->device->od;
    const uint32_t first = od->scope_instances[ODS_SCOPE_RPDO];
    const uint32_t end = od->scope_instances[ODS_SCOPE_TPDO + 1];
    const uint32_t rpdos = (uint32_t)od->scope_instances[ODS_SCOPE_TPDO] - first;

    for (uint32_t instance = first; instance < end; instance++) {
        const ods_pdo_values_t *const pdo = ods_od_instance(od, node->values, (uint16_t)instance);
        const uint32_t number = instance - first;
        const int receives = number < rpdos;
        const uint32_t other = receives ? number : number - rpdos;
        const uint32_t mapped = receives ? pdos->rpdos[other].pdo.mapped : pdos->tpdos[other].pdo.mapped;
        const uint32_t length = receives ? pdos->rpdos[other].pdo.length : pdos->tpdos[other].pdo.length;
        check_cob_id(pdo->pdo_cob_id);
        PROMISE(pdo->pdo_mapped_count <= od->max_mapped);
        PROMISE(mapped <= od->max_mapped);
        PROMISE(length <= 8u);
        PROMISE((mapped == 0u) || ((pdo->pdo_cob_id & 0x80000000u) == 0u));
    }
}

/* Each active RPDO is found under its CAN-ID, and nothing else is in the buckets. */
static void check_buckets(const rig_t *rig)
{
    const ods_pdo_t *const pdo = &rig->node->pdo;
    const ods_od_t *const od = rig->device->od;
    const uint32_t rpdos = (uint32_t)od->scope_instances[ODS_SCOPE_RPDO + 1] - od->scope_instances[ODS_SCOPE_RPDO];
    uint32_t found = 0;
    for (uint32_t bucket = 0; bucket < ODS_PDO_BUCKETS; bucket++) {
        for (const ods_rpdo_t *rpdo = pdo->buckets[bucket]; rpdo != NULL; rpdo = rpdo->next) {
            PROMISE((rpdo >= pdo->rpdos) && (rpdo < pdo->rpdos + rpdos));
            PROMISE(found < rpdos);
            found++;
        }
    }
}

void invariants_check_values(const rig_t *rig)
{
    for (uint32_t n = 0; n < rig->entry_count; n++) {
        if (is_limited(rig->device->od, rig->entries[n].ref.entry)) {
            check_value(rig, &rig->entries[n]);
        }
    }
    check_pdos(rig);
    check_buckets(rig);
    check_cob_id(rig->node->common->cob_id_emcy);
    check_cob_id(rig->node->common->cob_id_sync & 0x7FFFFFFFu);
}

/* ---- states ------------------------------------------------------------------------------------------------------ */

/* 1001h shows the classes of all conditions that hold, and bit 0 with any of them. */
static void check_error_register(const rig_t *rig)
{
    const ods_node_t *const node = rig->node;
    uint32_t expected = 0;
    for (uint32_t n = 0; n < rig->device->emergency_count; n++) {
        const ods_emergency_row_t *const row = &rig->device->emergencies[n];
        const uint32_t bit = 1u << row->condition;
        uint32_t holds = node->emcy.conditions & bit;
        for (uint32_t axis = 0; axis < rig->device->axes; axis++) {
            holds |= node->axes[axis].conditions & bit;
        }
        if ((holds != 0u) && (row->momentary == 0u)) {
            expected |= row->error_register | 1u;
        }
    }
    PROMISE(node->common->error_register == expected);
}

/* The statusword shows the state and, in bit 14, whether the axis moves; without power it does not. */
static void check_axis(const rig_t *rig, uint8_t number)
{
    const ods_axis_t *const axis = &rig->node->axes[number];
    uint32_t shown = 0;
    for (uint32_t n = 0; n < rig->device->pds_state_count; n++) {
        const ods_pds_state_row_t *const row = &rig->device->pds_states[n];
        shown += ((row->state == axis->state) && ((axis->values->statusword & row->mask) == row->value)) ? 1u : 0u;
    }
    PROMISE(shown == 1u);
    PROMISE((axis->velocity == 0) || rig_has_power(rig, number));
    PROMISE(((axis->values->statusword >> 14) & 1u) == ((axis->velocity != 0) ? 1u : 0u));
    PROMISE(axis->values->position_demand_value == axis->demand);
    PROMISE(axis->position / 1000000 == axis->demand);
}

static void check_sdo(const ods_node_t *node, const ods_od_t *od)
{
    if (node->sdo.phase != 0u) {
        PROMISE((node->sdo.ref.entry != NULL) && (node->sdo.ref.instance < od->scope_instances[ODS_SCOPES]));
        PROMISE(node->sdo.toggle == 0u || node->sdo.toggle == 0x10u || node->sdo.toggle == 1u);
    }
}

void invariants_check(const rig_t *rig, uint32_t now)
{
    const ods_node_t *const node = rig->node;
    uint32_t at = 0;

    PROMISE(
        (node->state == (uint8_t)ODS_NMT_STATE_INITIALISING) || (node->state == (uint8_t)ODS_NMT_STATE_STOPPED) ||
        (node->state == (uint8_t)ODS_NMT_STATE_PRE_OPERATIONAL) || (node->state == (uint8_t)ODS_NMT_STATE_OPERATIONAL));
    PROMISE((node->id >= 1u) && (node->id <= 127u));
    PROMISE(node->can <= (uint8_t)ODS_CAN_BUS_OFF);
    PROMISE(node->now == now);
    PROMISE(!ods_node_next(node, &at) || ((int32_t)(at - now) > 0));
    PROMISE(node->emcy.count <= ODS_EMCY_QUEUE);
    PROMISE(node->emcy.first < ODS_EMCY_QUEUE);
    for (uint32_t n = 0; n < ODS_LEDS; n++) {
        PROMISE((node->leds[n].row == ODS_NONE) || (node->leds[n].row < rig->device->led_count));
    }
    for (uint8_t n = 0; n < rig->device->axes; n++) {
        check_axis(rig, n);
    }
    check_sdo(node, rig->device->od);
    check_error_register(rig);
}
