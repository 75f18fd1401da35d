#include "ods_sync.h"

#include "ods_can.h"

uint32_t ods_sync_check_cob_id(uint32_t cob_id)
{
    const int valid = ((cob_id & (ODS_COB_ID_RESERVED | ODS_COB_ID_GENERATE)) == 0u) &&
                      !ods_can_id_restricted(cob_id);
    return valid ? 0u : ODS_ABORT_INVALID_VALUE;
}
