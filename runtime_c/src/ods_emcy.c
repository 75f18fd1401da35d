#include "ods_emcy.h"

#include <string.h>

#include "ods_axis.h"
#include "ods_can.h"
#include "ods_core.h"
#include "ods_nmt.h"

uint32_t ods_emcy_check_cob_id(uint32_t cob_id)
{
    if ((cob_id & ODS_COB_ID_RESERVED) != 0u) {
        return ODS_ABORT_INVALID_VALUE;
    }
    const int usable =
        ((cob_id & ODS_COB_ID_INVALID) != 0u) || !ods_can_id_restricted(cob_id);
    return usable ? 0u : ODS_ABORT_INVALID_VALUE;
}

static int is_fault(const ods_emergency_row_t *row)
{
    return (row->reaction == (uint8_t)ODS_REACTION_FAULT_RAMP) || (row->reaction == (uint8_t)ODS_REACTION_FAULT_OFF);
}

void ods_emcy_init(ods_node_t *node)
{
    for (uint32_t n = 0; n < node->device->emergency_count; n++) {
        const ods_emergency_row_t *const row = &node->device->emergencies[n];
        if (row->reaction == (uint8_t)ODS_REACTION_WARNING) {
            node->emcy.warnings |= 1u << row->condition;
        }
        if (is_fault(row)) {
            node->emcy.faults |= 1u << row->condition;
        }
    }
}

/* ---- queue ------------------------------------------------------------------------------------------------------- */

static void push(ods_node_t *node, uint8_t row, uint8_t axis, uint32_t error_register)
{
    ods_emcy_t *const emcy = &node->emcy;
    if (emcy->count < ODS_EMCY_QUEUE) {
        ods_emcy_item_t *const item = &emcy->queue[(emcy->first + emcy->count) % ODS_EMCY_QUEUE];
        item->row = row;
        item->axis = axis;
        item->error_register = (uint8_t)error_register;
        emcy->count++;
    }
    node->work |= ODS_WORK_EMCY;
}

/* Raise the rows of a condition, in the order of the table. */
static void push_rows(ods_node_t *node, uint32_t condition, uint8_t axis)
{
    for (uint8_t n = 0; n < node->device->emergency_count; n++) {
        const ods_emergency_row_t *const row = &node->device->emergencies[n];
        if (row->condition == condition) {
            push(node, n, axis, (uint32_t)node->common->error_register | row->error_register);
        }
    }
}

/* ---- error register ---------------------------------------------------------------------------------------------- */

static uint32_t present(const ods_node_t *node)
{
    uint32_t conditions = node->emcy.conditions;
    for (uint32_t axis = 0; axis < node->device->axes; axis++) {
        conditions |= node->axes[axis].conditions;
    }
    return conditions;
}

/* Rows of conditions that hold: their bits of the error register. */
static uint32_t register_of(const ods_node_t *node, uint32_t conditions)
{
    uint32_t error_register = 0;
    for (uint32_t n = 0; n < node->device->emergency_count; n++) {
        const ods_emergency_row_t *const row = &node->device->emergencies[n];
        if ((row->momentary == 0u) && (((conditions >> row->condition) & 1u) != 0u)) {
            error_register |= row->error_register;
        }
    }
    return error_register;
}

static void update_register(ods_node_t *node)
{
    const uint8_t error_register = (uint8_t)register_of(node, present(node));
    if (node->common->error_register != error_register) {
        node->common->error_register = error_register;
        ods_value_changed(node, ODS_DEVICE_INSTANCE);
    }
}

/* ---- conditions -------------------------------------------------------------------------------------------------- */

void ods_emcy_react(ods_node_t *node, ods_condition_t condition)
{
    for (uint32_t n = 0; n < node->device->emergency_count; n++) {
        const ods_emergency_row_t *const row = &node->device->emergencies[n];
        if ((row->condition != (uint8_t)condition) || (row->reaction == (uint8_t)ODS_REACTION_NONE)) {
            continue;
        }
        for (uint8_t axis = 0; axis < node->device->axes; axis++) {
            ods_axis_react(node, axis, row->reaction);
        }
    }
    if ((condition == ODS_CONDITION_HEARTBEAT_LOST) || (condition == ODS_CONDITION_BUS_OFF)) {
        ods_nmt_error(node, ODS_NMT_COMMUNICATION_ERROR);
    }
}

void ods_emcy_raise(ods_node_t *node, ods_condition_t condition, uint8_t axis)
{
    push_rows(node, condition, axis);
}

/* "Error reset" of the device: the row that a fault reset has, under the byte that means no axis. */
static void push_cleared(ods_node_t *node)
{
    for (uint8_t n = 0; n < node->device->emergency_count; n++) {
        if (node->device->emergencies[n].condition == (uint8_t)ODS_CONDITION_FAULT_RESET) {
            push(node, n, ODS_ALL_AXES, node->common->error_register);
            return;
        }
    }
    push(node, ODS_NONE, ODS_ALL_AXES, node->common->error_register);
}

void ods_emcy_set(ods_node_t *node, ods_condition_t condition, int holds)
{
    const uint32_t before = node->emcy.conditions;
    const uint32_t bit = 1u << condition;
    node->emcy.conditions = holds ? (before | bit) : (before & ~bit);
    if (node->emcy.conditions == before) {
        return;
    }
    update_register(node);
    node->work |= ODS_WORK_OUTPUT;
    if (holds) {
        push_rows(node, condition, ODS_ALL_AXES);
        ods_emcy_react(node, condition);
    } else if ((register_of(node, before) != 0u) && (register_of(node, node->emcy.conditions) == 0u)) {
        push_cleared(node);
    }
}

void ods_emcy_set_axis(ods_node_t *node, uint8_t axis, uint32_t conditions)
{
    const uint32_t begun = conditions & ~node->axes[axis].conditions;
    if (conditions == node->axes[axis].conditions) {
        return;
    }
    node->axes[axis].conditions = conditions;
    update_register(node);
    for (uint8_t n = 0; n < node->device->emergency_count; n++) {
        const ods_emergency_row_t *const row = &node->device->emergencies[n];
        if (((begun >> row->condition) & 1u) == 0u) {
            continue;
        }
        push(node, n, axis, node->common->error_register);
        ods_axis_react(node, axis, row->reaction);
        if (is_fault(row)) {
            ods_nmt_error(node, ODS_NMT_APPLICATION_ERROR);
        }
    }
}

void ods_emcy_reset(ods_node_t *node)
{
    node->emcy.count = 0;
    ods_timer_stop(node, ODS_TIMER_EMCY);
    update_register(node);
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

static void send_item(const ods_node_t *node, const ods_emcy_item_t *item)
{
    ods_frame_t frame = { 0 };
    frame.id = (uint16_t)(node->common->cob_id_emcy & ODS_CAN_ID_MASK);
    frame.length = 8;
    frame.data[2] = item->error_register;
    if (item->row != ODS_NONE) {
        const ods_emergency_row_t *const row = &node->device->emergencies[item->row];
        frame.data[0] = (uint8_t)row->code;
        frame.data[1] = (uint8_t)(row->code >> 8);
        memcpy(&frame.data[3], row->bytes, sizeof row->bytes);
        if (row->axis_byte != ODS_NONE) {
            frame.data[3u + row->axis_byte] = item->axis;
        }
    }
    ods_send(node, &frame);
}

void ods_emcy_transmit(ods_node_t *node)
{
    ods_emcy_t *const emcy = &node->emcy;
    if ((node->common->cob_id_emcy & ODS_COB_ID_INVALID) != 0u) {
        emcy->count = 0;
        return;
    }
    if (((node->services & ODS_SERVICE_EMCY) == 0u) || (node->can == (uint8_t)ODS_CAN_BUS_OFF)) {
        return;
    }
    while ((emcy->count != 0u) && !ods_timer_armed(node, ODS_TIMER_EMCY)) {
        const uint32_t inhibit_time = node->common->inhibit_time_emcy * ODS_US_PER_100US;
        send_item(node, &emcy->queue[emcy->first]);
        emcy->first = (uint8_t)((emcy->first + 1u) % ODS_EMCY_QUEUE);
        emcy->count--;
        if (inhibit_time != 0u) {
            ods_timer_start(node, ODS_TIMER_EMCY, node->now + inhibit_time);
        }
    }
}

uint8_t ods_emcy_driver_flags(const ods_node_t *node, uint32_t conditions)
{
    uint32_t flags = 0;
    for (uint32_t n = 0; (conditions != 0u) && (n < node->device->emergency_count); n++) {
        const ods_emergency_row_t *const row = &node->device->emergencies[n];
        if (((conditions >> row->condition) & 1u) != 0u) {
            flags |= row->driver_flag;
        }
    }
    return (uint8_t)flags;
}
