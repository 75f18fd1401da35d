/*
 * The SYNC consumer (CiA 301, 7.2.5). The node never produces SYNC.
 */
#ifndef ODS_SYNC_H
#define ODS_SYNC_H

#include "ods_core.h"

/* Whether a frame with this CAN-ID is the SYNC of the node. */
static inline int ods_sync_is(const ods_node_t *node, uint32_t can_id)
{
    return ((node->services & ODS_SERVICE_SYNC) != 0u) && ((node->common->cob_id_sync & ODS_CAN_ID_MASK) == can_id);
}

/* Whether 1005h may be so: 0 or an abort code. */
uint32_t ods_sync_check_cob_id(uint32_t cob_id);

#endif
