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

/* Whether the present state forbids the write. */
static uint32_t check_state(const ods_node_t *node, uint32_t instance, const ods_od_rule_t *rule)
{
    if (ods_is_axis_instance(node, instance)) {
        const uint32_t axis = instance - node->od->scope_instances[ODS_SCOPE_AXIS];
        const int is_open = (rule->states == 0u) || (((uint32_t)rule->states >> node->axes[axis].state) & 1u) != 0u;
        return (is_open && (node->common->tmcl_mode == 0u)) ? 0u : ODS_ABORT_DEVICE_STATE;
    }
    return ods_effect_state(node, instance, rule->effect);
}

/* A write has passed, and the value is in place. */
static uint32_t written(ods_node_t *node, uint32_t instance, uint32_t effect, const ods_od_entry_t *entry)
{
    if ((entry->kind & ODS_TX) != 0u) {
        ods_mark_changed(node, ods_entry_bit(entry));
    }
    if (effect >= (uint32_t)ODS_EFFECT_CONTROLWORD) {
        ods_axis_written(node, instance, effect, entry->at);
    } else if (effect != (uint32_t)ODS_EFFECT_VALUE) {
        ods_effect_apply(node, instance, effect);
    }
    return 0;
}

/*
 * The ways of a number. All are told the same, so that one passes it on to the next as it is: guarded or limited, if
 * its rule says so, and accepted.
 */
static inline uint32_t accept(ods_node_t *node, const ods_od_entry_t *entry, uint32_t instance, uint32_t number)
{
    ods_od_set_number(node->od, node->values, entry, instance, number);
    return written(node, instance, node->od->rules[entry->rule].effect, entry);
}

/* Nothing but its intervals can speak against it. */
ODS_RARE static uint32_t write_limited(
    ods_node_t *node, const ods_od_entry_t *entry, uint32_t instance, uint32_t number)
{
    const ods_od_rule_t *const rule = &node->od->rules[entry->rule];
    const uint32_t value = ods_od_cut(entry->kind, number);
    const uint32_t abort = ods_od_check(node->od, entry, rule, value);
    return (abort != 0u) ? abort : accept(node, entry, instance, value);
}

ODS_RARE static uint32_t write_guarded(
    ods_node_t *node, const ods_od_entry_t *entry, uint32_t instance, uint32_t number)
{
    const ods_od_rule_t *const rule = &node->od->rules[entry->rule];
    const uint32_t value = ods_od_cut(entry->kind, number);
    uint32_t abort = check_state(node, instance, rule);
    if (abort == 0u) {
        abort = ods_od_check(node->od, entry, rule, value);
    }
    if (abort == 0u) {
        abort = ods_effect_check(node, instance, rule->effect, value);
    }
    return (abort != 0u) ? abort : accept(node, entry, instance, value);
}

uint32_t ods_access_write_number(ods_node_t *node, const ods_od_entry_t *entry, uint32_t instance, uint32_t number)
{
    const uint32_t flags = node->od->rules[entry->rule].flags;
    if ((flags | node->common->tmcl_mode) == 0u) {
        return accept(node, entry, instance, number);
    }
    return (((flags & ODS_OD_GUARDED) | node->common->tmcl_mode) != 0u)
               ? write_guarded(node, entry, instance, number)
               : write_limited(node, entry, instance, number);
}

uint32_t ods_access_write(ods_node_t *node, const ods_od_ref_t *ref, const uint8_t *octets, uint16_t length)
{
    const ods_od_entry_t *const entry = ref->entry;
    if (ods_od_is_short(entry->kind)) {
        uint32_t number = 0;
        for (uint32_t n = 0; n < length; n++) {
            number |= (uint32_t)octets[n] << (8u * n);
        }
        return ods_access_write_number(node, entry, ref->instance, number);
    }
    const ods_od_rule_t *const rule = &node->od->rules[entry->rule];
    const uint32_t abort = check_state(node, ref->instance, rule);
    if (abort != 0u) {
        return abort;
    }
    ods_od_set_octets(node->od, node->values, ref, octets, length);
    return written(node, ref->instance, rule->effect, entry);
}
