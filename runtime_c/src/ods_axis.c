#include "ods_axis.h"

#include "ods_core.h"
#include "ods_emcy.h"

/* Bits of the statusword 6041h that no mode owns (CiA 402). */
#define STATUS_VOLTAGE_ENABLED 0x0010u
#define STATUS_WARNING 0x0080u
#define STATUS_REMOTE 0x0200u

/* What the statusword shows of the PDS state. */
static uint32_t state_bits(const ods_node_t *node, uint8_t state)
{
    for (uint32_t n = 0; n < node->device->pds_state_count; n++) {
        if (node->device->pds_states[n].state == state) {
            return node->device->pds_states[n].value;
        }
    }
    return 0;
}

/* Whether a condition with the reaction of a warning holds. */
static int is_warned(const ods_node_t *node, uint32_t conditions)
{
    for (uint32_t n = 0; n < node->device->emergency_count; n++) {
        const ods_emergency_row_t *const row = &node->device->emergencies[n];
        if ((row->reaction == (uint8_t)ODS_REACTION_WARNING) && (((conditions >> row->condition) & 1u) != 0u)) {
            return 1;
        }
    }
    return 0;
}

void ods_axis_update(ods_node_t *node, uint8_t axis)
{
    ods_axis_values_t *const values = ods_axis_values(node, axis);
    const uint32_t conditions = node->axes[axis].conditions;
    uint32_t status = state_bits(node, node->axes[axis].state);

    if ((((node->emcy.conditions >> ODS_CONDITION_SHUTDOWN_SWITCH) & 1u) == 0u) &&
        (((conditions >> ODS_CONDITION_UNDERVOLTAGE) & 1u) == 0u)) {
        status |= STATUS_VOLTAGE_ENABLED;
    }
    if (is_warned(node, conditions)) {
        status |= STATUS_WARNING;
    }
    if (node->common->tmcl_mode == 0u) {
        status |= STATUS_REMOTE;
    }
    if (values->statusword != (uint16_t)status) {
        values->statusword = (uint16_t)status;
        ods_value_changed(node, ods_axis_instance(node, axis));
    }
}

void ods_axis_update_all(ods_node_t *node)
{
    for (uint8_t axis = 0; axis < node->device->axes; axis++) {
        ods_axis_update(node, axis);
    }
}

void ods_axis_reset(ods_node_t *node, uint8_t axis)
{
    node->axes[axis].conditions = 0;
    node->axes[axis].state = ODS_PDS_STATE_SWITCH_ON_DISABLED;
    ods_axis_update(node, axis);
}

void ods_axis_written(ods_node_t *node, uint32_t instance, uint32_t effect)
{
    /* At rest an axis obeys nothing. */
    (void)node;
    (void)instance;
    (void)effect;
}

void ods_axis_react(ods_node_t *node, uint8_t axis, uint8_t reaction)
{
    (void)reaction;
    ods_axis_update(node, axis);
}

void ods_axis_network_stopped(ods_node_t *node)
{
    ods_axis_update_all(node);
}

void ods_axis_tick(ods_node_t *node, uint8_t axis)
{
    ods_emcy_set_axis(node, axis, node->axes[axis].faults);
    ods_axis_update(node, axis);
}

int ods_axis_is_armed(const ods_node_t *node, uint8_t axis)
{
    return node->axes[axis].faults != node->axes[axis].conditions;
}
