#include "ods_effect.h"

#include "ods_axis.h"
#include "ods_core.h"
#include "ods_emcy.h"
#include "ods_heartbeat.h"
#include "ods_io.h"
#include "ods_os_command.h"
#include "ods_pdo.h"
#include "ods_store.h"
#include "ods_sync.h"

static uint32_t sub_of(const ods_node_t *node)
{
    return node->sdo.address >> 16;
}

uint32_t ods_effect_state(const ods_node_t *node, uint32_t instance, uint32_t effect)
{
    switch (effect) {
    case ODS_EFFECT_PDO_MAPPED_COUNT:
    case ODS_EFFECT_PDO_MAPPING:
        return ods_pdo_mapping_state(node, instance, sub_of(node));
    case ODS_EFFECT_OS_COMMAND:
        return (node->common->tmcl_mode == 0u) ? ODS_ABORT_DEVICE_STATE : 0u;
    default:
        return 0;
    }
}

uint32_t ods_effect_check(ods_node_t *node, uint32_t instance, uint32_t effect, uint32_t value)
{
    switch (effect) {
    case ODS_EFFECT_COB_ID_SYNC:
        return ods_sync_check_cob_id(value);
    case ODS_EFFECT_COB_ID_EMCY:
        return ods_emcy_check_cob_id(value);
    case ODS_EFFECT_CONSUMER_HEARTBEAT:
        return ods_heartbeat_check_consumer(node, (uint8_t)sub_of(node), value);
    case ODS_EFFECT_PDO_COB_ID:
        return ods_pdo_check_cob_id(node, instance, value);
    case ODS_EFFECT_PDO_MAPPED_COUNT:
        return ods_pdo_check_count(node, instance, value);
    case ODS_EFFECT_PDO_MAPPING:
        return ods_pdo_check_mapping(node, instance, sub_of(node), value);
    case ODS_EFFECT_STORE:
        return ods_store_save(node, (uint16_t)node->sdo.address, (uint8_t)sub_of(node));
    case ODS_EFFECT_RESTORE:
        return ods_store_restore(node, (uint16_t)node->sdo.address, (uint8_t)sub_of(node));
    default:
        return 0;
    }
}

void ods_effect_apply(ods_node_t *node, uint32_t instance, uint32_t effect)
{
    switch (effect) {
    case ODS_EFFECT_GUARD_TIME:
        ods_heartbeat_guard_written(node);
        break;
    case ODS_EFFECT_COB_ID_EMCY:
        node->work |= ODS_WORK_EMCY;
        break;
    case ODS_EFFECT_CONSUMER_HEARTBEAT:
        ods_heartbeat_consumer_written(node, (uint8_t)sub_of(node));
        break;
    case ODS_EFFECT_PRODUCER_HEARTBEAT:
        ods_heartbeat_producer_written(node);
        break;
    case ODS_EFFECT_PDO_COB_ID:
        ods_pdo_cob_id_written(node, instance);
        break;
    case ODS_EFFECT_PDO_MAPPED_COUNT:
    case ODS_EFFECT_PDO_MAPPING:
        ods_pdo_mapping_written(node, instance, sub_of(node));
        break;
    case ODS_EFFECT_PDO_PARAMETER:
        ods_pdo_parameter_written(node, instance, sub_of(node));
        break;
    case ODS_EFFECT_OS_COMMAND:
        ods_os_command_run(node);
        break;
    case ODS_EFFECT_TMCL_MODE:
        node->common->tmcl_mode = (node->common->tmcl_mode == ODS_SIGNATURE_MAKE);
        ods_axis_update_all(node);
        break;
    case ODS_EFFECT_MANUFACTURER_MODE:
        node->common->manufacturer_mode = (node->common->manufacturer_mode == ODS_SIGNATURE_MAKE);
        break;
    case ODS_EFFECT_DIGITAL_OUTPUTS:
    case ODS_EFFECT_OUTPUT_MASK:
    case ODS_EFFECT_ANALOG_OUTPUTS:
        node->work |= ODS_WORK_OUTPUT;
        break;
    default:
        break;
    }
}
