#include "ods_nmt.h"

#include "ods_axis.h"
#include "ods_can.h"
#include "ods_core.h"
#include "ods_emcy.h"
#include "ods_heartbeat.h"
#include "ods_io.h"
#include "ods_od.h"
#include "ods_pdo.h"
#include "ods_sdo.h"
#include "ods_store.h"

static void enter(ods_node_t *node, uint8_t state)
{
    if (state == node->state) {
        return;
    }
    node->state = state;
    node->services = 0;
    for (uint32_t n = 0; n < node->device->nmt_state_count; n++) {
        if (node->device->nmt_states[n].state == state) {
            node->services = node->device->nmt_states[n].services;
        }
    }
    if ((node->services & ODS_SERVICE_PDO) != 0u) {
        ods_pdo_start(node);
    }
    if ((node->services & ODS_SERVICE_SDO) == 0u) {
        ods_sdo_abandon(node);
    }
    if (state == (uint8_t)ODS_NMT_STATE_STOPPED) {
        ods_axis_network_stopped(node);
    }
    node->work |= ODS_WORK_EMCY | ODS_WORK_OUTPUT;
}

/* Communication starts anew under the node-ID in force. Its values are already those after the reset. */
static void start_communication(ods_node_t *node)
{
    enter(node, ODS_NMT_STATE_INITIALISING);
    node->work &= (uint8_t) ~(ODS_WORK_HEARTBEAT | ODS_WORK_ERROR_BEHAVIOUR);
    if (node->config.serial_number != 0u) {
        node->common->serial_number = node->config.serial_number;
    }
    ods_heartbeat_reset(node);
    ods_emcy_reset(node);
    ods_pdo_reset(node);
    ods_heartbeat_boot_up(node);
    enter(node, ODS_NMT_STATE_PRE_OPERATIONAL);
}

static void reset_communication(ods_node_t *node)
{
    ods_od_defaults(node->od, node->values, node->id, 1);
    ods_store_load(node, 1);
    start_communication(node);
}

/* Defaults, then what is stored. */
static void load_values(ods_node_t *node)
{
    ods_od_defaults(node->od, node->values, node->id, 0);
    if (node->config.node_id != 0u) {
        node->common->node_id = node->config.node_id;
    }
    ods_store_load(node, 0);
}

/* The address switches count while they show a node-ID; else the stored one does. */
static uint8_t choose_node_id(const ods_node_t *node)
{
    const uint8_t address = node->io.address;
    if ((address >= 1u) && (address <= ODS_NODE_IDS)) {
        return address;
    }
    return (node->common->node_id == 0u) ? 1u : node->common->node_id;
}

/* The stored bit rate; a device that cannot be told runs at the highest that it has. */
static uint16_t choose_bit_rate(const ods_node_t *node)
{
    const uint32_t count = node->device->bit_rate_count;
    if ((node->common->can_bit_rate == 0u) && (count != 0u)) {
        return node->device->bit_rates[count - 1u];
    }
    return node->common->can_bit_rate;
}

void ods_nmt_reset_node(ods_node_t *node)
{
    load_values(node);
    node->id = choose_node_id(node);
    load_values(node); /* now that the node-ID is known that some defaults depend on */
    node->common->node_id_load = node->id;
    node->common->can_bit_rate_load = choose_bit_rate(node);
    if (node->port->bus != NULL) {
        node->port->bus(node->port->context, node->common->can_bit_rate_load, node->id);
    }
    node->emcy.conditions = 0;
    ods_io_reset(node);
    for (uint8_t axis = 0; axis < node->device->axes; axis++) {
        ods_axis_reset(node, axis);
    }
    start_communication(node);
    ods_can_reset(node);
    ods_tick_arm(node); /* inputs and faults are found anew */
}

void ods_nmt_receive(ods_node_t *node, const ods_frame_t *frame)
{
    const uint8_t addressed = frame->data[1];
    if ((frame->length != 2u) || (frame->remote != 0u) || ((addressed != 0u) && (addressed != node->id))) {
        return;
    }
    for (uint32_t n = 0; n < node->device->nmt_command_count; n++) {
        const ods_nmt_command_row_t *const row = &node->device->nmt_commands[n];
        if (row->command != frame->data[0]) {
            continue;
        }
        if (row->command == (uint8_t)ODS_NMT_COMMAND_RESET_NODE) {
            ods_nmt_reset_node(node);
        } else if (row->command == (uint8_t)ODS_NMT_COMMAND_RESET_COMMUNICATION) {
            reset_communication(node);
        } else {
            enter(node, row->state);
        }
    }
}

void ods_nmt_error(ods_node_t *node, ods_nmt_error_t error)
{
    const uint8_t behaviour = node->common->error_behaviour[error];
    if (node->state != (uint8_t)ODS_NMT_STATE_OPERATIONAL) {
        return;
    }
    for (uint32_t n = 0; n < node->device->error_behaviour_count; n++) {
        if (node->device->error_behaviours[n].value == behaviour) {
            node->next_state = node->device->error_behaviours[n].state;
            node->work |= ODS_WORK_ERROR_BEHAVIOUR;
        }
    }
}

void ods_nmt_follow_error(ods_node_t *node)
{
    enter(node, node->next_state);
}
