/*
 * What the CAN controller reports: its state and its losses.
 */
#ifndef ODS_CAN_H
#define ODS_CAN_H

#include "ods/node.h"

/* A new state of the controller, or something that happened to it. */
void ods_can_report(ods_node_t *node, ods_can_t event);

/* After reset node: the controller is in the state in which it was. */
void ods_can_reset(ods_node_t *node);

#endif
