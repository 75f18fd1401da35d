#include "ods_sync.h"

#include "ods_core.h"

int ods_sync_is(const ods_node_t *node, uint32_t can_id)
{
    return ((node->services & ODS_SERVICE_SYNC) != 0u) && ((node->common->cob_id_sync & ODS_CAN_ID_MASK) == can_id);
}

uint32_t ods_sync_check_cob_id(uint32_t cob_id)
{
    const int valid = ((cob_id & (ODS_COB_ID_RESERVED | ODS_COB_ID_GENERATE)) == 0u) &&
                      !ods_can_id_restricted(cob_id & ODS_CAN_ID_MASK);
    return valid ? 0u : ODS_ABORT_INVALID_VALUE;
}
