/*
 * The cyclic modes: set-points in a fixed cycle (manual, sections 9 and 10).
 */
#ifndef ODS_CYCLIC_H
#define ODS_CYCLIC_H

#include "ods/node.h"

void ods_cyclic_reset(ods_axis_t *axis);

/* A set-point came: the cycle starts. */
void ods_cyclic_written(ods_axis_t *axis);

/* The set-point has to be reached within one cycle from now on (60C2h); 0 is one tick. */
void ods_cyclic_restart(ods_axis_t *axis);

/* The velocity that reaches a position in microsteps in time; positions wrap, the shorter way counts. */
int64_t ods_cyclic_position(ods_axis_t *axis, int32_t goal);

/* The velocity on the way to a velocity in 1/1000 microstep per second. */
int64_t ods_cyclic_velocity(ods_axis_t *axis, int64_t goal, int64_t velocity);

/* Set-points with their offsets: microsteps; 1/1000 microstep per second. */
int64_t ods_cyclic_target_position(const ods_axis_values_t *values);
int64_t ods_cyclic_target_velocity(const ods_axis_values_t *values);

#endif
