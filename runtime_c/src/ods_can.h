/*
 * The CAN bus: which CAN-IDs are taken, and what the controller reports, its state and its losses.
 */
#ifndef ODS_CAN_H
#define ODS_CAN_H

#include "ods/node.h"

/* Whether the CAN-ID of a COB-ID is one that no COB-ID may have (CiA 301, 7.3.5). */
int ods_can_id_restricted(uint32_t cob_id);

/* A new state of the controller, or something that happened to it. */
void ods_can_report(ods_node_t *node, ods_can_t event);

/* After reset node: the controller is in the state in which it was. */
void ods_can_reset(ods_node_t *node);

#endif
