/*
 * Error control: the heartbeats that the node sends and watches, and guarding (CiA 301, 7.2.8).
 *
 * The producer keeps a fixed grid. A consumer is armed by the first heartbeat of the node that it watches; a boot-up
 * message disarms it. Guarding is answered while no heartbeat is produced, and life guarding runs from the first
 * request on. Its time can be longer than a timer lasts, so it counts ticks.
 */
#ifndef ODS_HEARTBEAT_H
#define ODS_HEARTBEAT_H

#include "ods/node.h"

/* Whether 1016h may be so: 0 or an abort code. */
uint32_t ods_heartbeat_check_consumer(const ods_node_t *node, uint32_t sub, uint32_t value);

/* A parameter was written. */
void ods_heartbeat_consumer_written(ods_node_t *node, uint32_t sub);
void ods_heartbeat_producer_written(ods_node_t *node);
void ods_heartbeat_guard_written(ods_node_t *node);

/* After a reset. */
void ods_heartbeat_reset(ods_node_t *node);

/* A frame of error control, of this node's master or of another node. */
void ods_heartbeat_receive(ods_node_t *node, const ods_frame_t *frame);

/* What is missing now. */
void ods_heartbeat_expire(ods_node_t *node);

/* Send a heartbeat. */
void ods_heartbeat_transmit(const ods_node_t *node);

/* Send the boot-up message. */
void ods_heartbeat_boot_up(const ods_node_t *node);

#endif
