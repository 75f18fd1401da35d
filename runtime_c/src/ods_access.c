#include "ods_access.h"

#include "ods_axis.h"
#include "ods_core.h"
#include "ods_effect.h"
#include "ods_od.h"

/* In TMCL mode the objects of the axes are out of reach. */
static int is_handed_over(const ods_node_t *node, uint32_t instance)
{
    return (node->common->tmcl_mode != 0u) && ods_is_axis_instance(node, instance);
}

uint32_t ods_access_readable(const ods_node_t *node, const ods_od_ref_t *ref)
{
    if ((ref->entry->kind & ODS_READ) == 0u) {
        return ODS_ABORT_WRITE_ONLY;
    }
    return is_handed_over(node, ref->instance) ? ODS_ABORT_DEVICE_STATE : 0u;
}

uint32_t ods_access_length(const ods_node_t *node, const ods_od_entry_t *entry, uint32_t length)
{
    const uint32_t room = ods_od_room(node->od, entry);
    if (length > room) {
        return ODS_ABORT_TOO_LONG;
    }
    if ((length < room) && ((entry->kind & ODS_TYPE_MASK) != ODS_VISIBLE_STRING)) {
        return ODS_ABORT_TOO_SHORT;
    }
    return 0;
}

/* Effects that only look at a value later, or belong to an axis: they refuse nothing. */
static int is_plain(uint32_t effect)
{
    return (effect == ODS_EFFECT_VALUE) || (effect >= ODS_EFFECT_CONTROLWORD);
}

/* Whether the present state forbids the write. */
static uint32_t check_state(const ods_node_t *node, const ods_target_t *target, const ods_od_rule_t *rule)
{
    if (ods_is_axis_instance(node, target->ref.instance)) {
        const uint32_t axis = target->ref.instance - node->od->scope_instances[ODS_SCOPE_AXIS];
        const int is_open = (rule->states == 0u) || (((uint32_t)rule->states >> node->axes[axis].state) & 1u) != 0u;
        return (is_open && (node->common->tmcl_mode == 0u)) ? 0u : ODS_ABORT_DEVICE_STATE;
    }
    return is_plain(rule->effect) ? 0u : ods_effect_state(node, target, rule->effect);
}

/* Everything that may refuse a number. */
ODS_RARE static uint32_t check(
    ods_node_t *node, const ods_target_t *target, const ods_od_rule_t *rule, uint32_t number)
{
    uint32_t abort = check_state(node, target, rule);
    if ((abort == 0u) && (rule->intervals != 0u)) {
        abort = ods_od_check(node->od, target->ref.entry, rule, number);
    }
    return ((abort == 0u) && !is_plain(rule->effect)) ? ods_effect_check(node, target, rule->effect, number) : abort;
}

/* A write has passed, and the value is in place. */
static uint32_t written(ods_node_t *node, const ods_target_t *target, const ods_od_rule_t *rule)
{
    const uint32_t instance = target->ref.instance;
    if ((target->ref.entry->kind & ODS_TX) != 0u) {
        ods_mark_changed(node, ods_entry_bit(target->ref.entry));
    }
    if (rule->effect >= (uint8_t)ODS_EFFECT_CONTROLWORD) {
        const uint32_t axis = instance - node->od->scope_instances[ODS_SCOPE_AXIS];
        if (axis < node->device->axes) {
            ods_axis_written(node, axis, rule->effect);
        }
    } else if (rule->effect != (uint8_t)ODS_EFFECT_VALUE) {
        ods_effect_apply(node, target, rule->effect);
    }
    return 0;
}

uint32_t ods_access_write_number(ods_node_t *node, const ods_target_t *target, uint32_t number)
{
    const ods_od_rule_t *const rule = &node->od->rules[target->ref.entry->rule];
    uint32_t abort = 0;

    if (!is_plain(rule->effect) || (rule->states != 0u) || (node->common->tmcl_mode != 0u)) {
        abort = check(node, target, rule, number);
    } else if (rule->intervals != 0u) {
        abort = ods_od_check(node->od, target->ref.entry, rule, number);
    }
    if (abort != 0u) {
        return abort;
    }
    ods_od_set_number(node->od, node->values, &target->ref, number);
    return written(node, target, rule);
}

uint32_t ods_access_write(ods_node_t *node, const ods_target_t *target, const uint8_t *octets, uint16_t length)
{
    const ods_od_entry_t *const entry = target->ref.entry;
    if (ods_od_is_number(entry->kind) && !ods_od_is_long(entry->kind)) {
        uint32_t number = 0;
        for (uint32_t n = 0; n < length; n++) {
            number |= (uint32_t)octets[n] << (8u * n);
        }
        return ods_access_write_number(node, target, number);
    }
    const ods_od_rule_t *const rule = &node->od->rules[entry->rule];
    const uint32_t abort = check_state(node, target, rule);
    if (abort != 0u) {
        return abort;
    }
    ods_od_set_octets(node->od, node->values, &target->ref, octets, length);
    return written(node, target, rule);
}
