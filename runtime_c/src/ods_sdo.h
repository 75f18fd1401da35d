/*
 * The SDO server: expedited and segmented transfers (CiA 301, 7.2.4). Block transfer is refused.
 */
#ifndef ODS_SDO_H
#define ODS_SDO_H

#include "ods/node.h"

/* A frame to the server. */
void ods_sdo_receive(ods_node_t *node, const ods_frame_t *frame);

/* Give a silent client up, if it is time to. */
void ods_sdo_time_out(ods_node_t *node);

/* End a transfer without a word: on a reset and in STOPPED. */
void ods_sdo_abandon(ods_node_t *node);

#endif
