/*
 * Homing: how an axis looks for its home position (manual, section 8).
 *
 * The device's table says for each method which switch counts, where the search sets out, and in which direction the
 * axis travels when it takes the edge, from active to inactive. The switch is found fast, its edge is passed slowly,
 * and there the axis stands.
 */
#ifndef ODS_HOMING_H
#define ODS_HOMING_H

#include "ods/node.h"

/* Another mode took over. What is requested stays. */
void ods_homing_forget(ods_axis_t *axis);

/* The axis is in operation again: a search from before is over. */
void ods_homing_enabled(ods_axis_t *axis);

/* Bit 4 of the controlword starts and stops. */
void ods_homing_control(ods_axis_t *axis, uint32_t word, uint32_t before);

/* What was asked for begins, in a tick in which homing is in force. */
void ods_homing_begin(const ods_node_t *node, ods_axis_t *axis, int is_enabled);

/* The velocity of this tick. */
int64_t ods_homing_step(ods_axis_t *axis, int64_t velocity);

static inline int ods_homing_runs(const ods_axis_t *axis)
{
    return axis->homing.phase != 0u;
}

#endif
