/*
 * The encoder of an axis: where the shaft really is.
 *
 * It is in use while 608Fh:01 is not 0. Then an increment is 2001h * 2^(2000h) * 608Fh:02 / 608Fh:01 microsteps.
 */
#ifndef ODS_ENCODER_H
#define ODS_ENCODER_H

#include "ods/node.h"

/* It counts from where it is. */
void ods_encoder_reset(ods_axis_t *axis);

static inline int ods_encoder_is_used(const ods_axis_t *axis)
{
    return axis->values->encoder_increments != 0u;
}

/* The shaft stands at a position in microsteps. */
static inline void ods_encoder_set_position(ods_axis_t *axis, int32_t position)
{
    axis->encoder.origin = position;
    axis->encoder.position = position;
    axis->encoder.increments = 0;
}

/* Where the axis went in a tick: without an encoder in use the shaft is there. */
static inline void ods_encoder_follow(ods_axis_t *axis, int32_t position)
{
    if (!ods_encoder_is_used(axis)) {
        ods_encoder_set_position(axis, position);
    }
}

/* Read the encoder. Before the axis moves in a tick. */
void ods_encoder_sample(ods_axis_t *axis);

/* Counts made before are not read anew. */
static inline void ods_encoder_parameter_written(ods_axis_t *axis)
{
    ods_encoder_set_position(axis, axis->encoder.position);
}

#endif
