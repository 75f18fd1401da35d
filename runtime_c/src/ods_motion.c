#include "ods_motion.h"

#define WRAP ((INT64_C(1) << 32) * ODS_PER_MICROSTEP)

int64_t ods_motion_wrap(ods_axis_t *axis, int64_t demand)
{
    axis->position += (demand > 0) ? -WRAP : WRAP;
    return axis->position / ODS_PER_MICROSTEP;
}

static void put(ods_axis_t *axis, int32_t position)
{
    axis->position = (int64_t)position * ODS_PER_MICROSTEP;
    axis->demand = position;
}

void ods_motion_set_position(ods_axis_t *axis, int32_t position)
{
    put(axis, position);
    ods_encoder_set_position(axis, position);
}

void ods_motion_start_from_encoder(ods_axis_t *axis)
{
    if (ods_encoder_is_used(axis)) {
        put(axis, axis->encoder.position);
    }
}
