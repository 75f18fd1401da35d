/*
 * Emergencies (CiA 301, 7.2.7): from a condition to the error register, the reaction and the frame.
 *
 * A row of the device's table is raised on the edge of its condition. Rows of conditions that hold make up the error
 * register; momentary rows show in their frame only.
 */
#ifndef ODS_EMCY_H
#define ODS_EMCY_H

#include "ods/node.h"

/* Learn from the table what conditions do. */
void ods_emcy_init(ods_node_t *node);

/* What the driver error flags (2102h) show of conditions: bit 1 << ods_condition_t. */
uint8_t ods_emcy_driver_flags(const ods_node_t *node, uint32_t conditions);

/* Whether a condition with the reaction of a warning is among these. */
static inline int ods_emcy_is_warned(const ods_node_t *node, uint32_t conditions)
{
    return (conditions & node->emcy.warnings) != 0u;
}

/* Whether one of these conditions, or of those of the device, is a fault. */
static inline int ods_emcy_has_fault_cause(const ods_node_t *node, uint32_t conditions)
{
    return ((conditions | node->emcy.conditions) & node->emcy.faults) != 0u;
}

/* Whether 1014h may be so: 0 or an abort code. */
uint32_t ods_emcy_check_cob_id(uint32_t cob_id);

/* A condition of the whole device holds or has ended. */
void ods_emcy_set(ods_node_t *node, ods_condition_t condition, int holds);

/* The conditions of an axis that hold now: bit 1 << ods_condition_t. */
void ods_emcy_set_axis(ods_node_t *node, uint8_t axis, uint32_t conditions);

/* Something happened: raise the rows of a momentary condition. `axis` is ODS_ALL_AXES where it concerns the device. */
void ods_emcy_raise(ods_node_t *node, ods_condition_t condition, uint8_t axis);

/* Carry out the reactions to a condition of the whole device without raising it. */
void ods_emcy_react(ods_node_t *node, ods_condition_t condition);

/* Forget what is queued. */
void ods_emcy_reset(ods_node_t *node);

/* Send what may leave now. */
void ods_emcy_transmit(ods_node_t *node);

#endif
