/*
 * The NMT slave (CiA 301, 7.2.8, 7.3.2): states, commands and resets.
 */
#ifndef ODS_NMT_H
#define ODS_NMT_H

#include "ods/node.h"

/* Which entry of 1029h decides. */
typedef enum {
    ODS_NMT_COMMUNICATION_ERROR,
    ODS_NMT_APPLICATION_ERROR
} ods_nmt_error_t;

/* A frame of the NMT master. */
void ods_nmt_receive(ods_node_t *node, const ods_frame_t *frame);

/* Reset node, also at power-on: every value, the axes, node-ID and bit rate. */
void ods_nmt_reset_node(ods_node_t *node);

/* An error occurred: 1029h decides what becomes of the state, once the emergencies of this turn have left. */
void ods_nmt_error(ods_node_t *node, ods_nmt_error_t error);

/* Carry out what ods_nmt_error() has decided. */
void ods_nmt_follow_error(ods_node_t *node);

#endif
