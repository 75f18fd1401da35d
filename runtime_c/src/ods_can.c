#include "ods_can.h"

#include "ods_core.h"
#include "ods_emcy.h"

int ods_can_id_restricted(uint32_t cob_id)
{
    const uint32_t id = cob_id & ODS_CAN_ID_MASK;
    return (id <= 0x07Fu) || ((id >= 0x101u) && (id <= 0x180u)) || ((id >= 0x581u) && (id <= 0x5FFu)) ||
           ((id >= 0x601u) && (id <= 0x67Fu)) || (id >= 0x6E0u);
}

static void set_conditions(ods_node_t *node)
{
    ods_emcy_set(node, ODS_CONDITION_CAN_WARNING, node->can >= (uint8_t)ODS_CAN_WARNING);
    ods_emcy_set(node, ODS_CONDITION_CAN_PASSIVE, node->can >= (uint8_t)ODS_CAN_PASSIVE);
}

static void enter(ods_node_t *node, ods_can_t state)
{
    const int was_off = node->can == (uint8_t)ODS_CAN_BUS_OFF;
    const int is_off = state == ODS_CAN_BUS_OFF;
    node->can = (uint8_t)state;
    node->work |= ODS_WORK_OUTPUT;
    if (is_off && !was_off) {
        /* Its emergency could not leave: it is raised when the node is back. */
        ods_emcy_react(node, ODS_CONDITION_BUS_OFF);
    }
    if (was_off && !is_off) {
        ods_emcy_raise(node, ODS_CONDITION_BUS_OFF, ODS_ALL_AXES);
        node->work |= ODS_WORK_EMCY | ODS_WORK_TPDO;
    }
    set_conditions(node);
}

void ods_can_report(ods_node_t *node, ods_can_t event)
{
    switch (event) {
    case ODS_CAN_OK:
    case ODS_CAN_WARNING:
    case ODS_CAN_PASSIVE:
    case ODS_CAN_BUS_OFF:
        enter(node, event);
        break;
    case ODS_CAN_ERROR:
        ods_emcy_raise(node, ODS_CONDITION_COMMUNICATION_ERROR, ODS_ALL_AXES);
        break;
    case ODS_CAN_OVERRUN:
        ods_emcy_raise(node, ODS_CONDITION_CAN_OVERRUN, ODS_ALL_AXES);
        break;
    case ODS_CAN_TX_FULL:
        ods_emcy_raise(node, ODS_CONDITION_CAN_TX_FULL, ODS_ALL_AXES);
        break;
    case ODS_CAN_RX_FULL:
        ods_emcy_raise(node, ODS_CONDITION_CAN_RX_FULL, ODS_ALL_AXES);
        break;
    default:
        break;
    }
}

void ods_can_reset(ods_node_t *node)
{
    set_conditions(node);
}
