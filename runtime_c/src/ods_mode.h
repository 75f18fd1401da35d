/*
 * Modes of operation: what an axis in operation does in a tick.
 */
#ifndef ODS_MODE_H
#define ODS_MODE_H

#include "ods_axis.h"

/* At power-on. */
void ods_mode_reset(const ods_node_t *node, ods_axis_t *axis);

/* Whether the mode has something to do in the next tick. */
int ods_mode_is_armed(const ods_axis_t *axis);

/* The axis is in operation: old set-points are forgotten. */
void ods_mode_enabled(ods_axis_t *axis);

/* The bits of the controlword that belong to the mode asked for. */
void ods_mode_control(ods_axis_t *axis, uint32_t word, uint32_t before);

/* A set-point of a cyclic mode: the axis follows it if that mode is asked for. Whether it has begun to do so. */
int ods_mode_target_written(ods_axis_t *axis, ods_mode_t mode);

/* The sum of target and offset has to be reached anew. */
void ods_mode_offset_written(ods_axis_t *axis);

/* A parameter of the ramp was written, or their unit. */
static inline void ods_mode_ramp_written(ods_axis_t *axis)
{
    axis->far = INT64_MAX; /* not known yet */
}

/* 6067h or 6068h was written: whether the target is reached is judged anew. */
void ods_mode_window_written(ods_axis_t *axis);

void ods_mode_tick(ods_node_t *node, ods_axis_t *axis);

/* The bits of the statusword that tell of the mode. */
static inline uint32_t ods_mode_status(const ods_axis_t *axis)
{
    if (axis->values->modes_of_operation_display == (int8_t)ODS_MODE_HOMING) {
        return axis->homing.status;
    }
    if ((axis->flags & ODS_AXIS_ENABLED) == 0u) {
        return 0;
    }
    return (axis->flags & (ODS_AXIS_REACHED | ODS_AXIS_CLAMPED | ODS_AXIS_ACKNOWLEDGED)) |
           ((axis->cyclic.is_following != 0u) ? ODS_AXIS_ACKNOWLEDGED : 0u);
}

#endif
