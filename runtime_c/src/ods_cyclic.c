#include "ods_cyclic.h"

#include "ods_units.h"

#define HALF ((INT64_C(1) << 31) * ODS_PER_MICROSTEP)
#define LEAST_EXPONENT (-3) /* of 60C2h: a millisecond, which is a tick */

void ods_cyclic_reset(ods_axis_t *axis)
{
    axis->cyclic.is_following = 0;
    axis->cyclic.ticks = 0;
}

void ods_cyclic_written(ods_axis_t *axis)
{
    axis->cyclic.is_following = 1;
    ods_cyclic_restart(axis);
}

void ods_cyclic_restart(ods_axis_t *axis)
{
    uint32_t ticks = axis->values->interpolation_time_period_value;
    for (int32_t exponent = axis->values->interpolation_time_period_index; exponent > LEAST_EXPONENT; exponent--) {
        ticks *= 10u;
    }
    axis->cyclic.ticks = (ticks == 0u) ? 1u : ticks;
}

/* What of it falls to this tick. */
static int64_t share(ods_axis_t *axis, int64_t rest)
{
    if (axis->cyclic.ticks == 0u) {
        return 0;
    }
    return rest / axis->cyclic.ticks--;
}

int64_t ods_cyclic_position(ods_axis_t *axis, int32_t goal)
{
    int64_t way = (int64_t)goal * ODS_PER_MICROSTEP - axis->position;
    if (way >= HALF) {
        way -= 2 * HALF;
    } else if (way < -HALF) {
        way += 2 * HALF;
    }
    return share(axis, way);
}

int64_t ods_cyclic_velocity(ods_axis_t *axis, int64_t goal, int64_t velocity)
{
    return (axis->cyclic.ticks == 0u) ? goal : velocity + share(axis, goal - velocity);
}

int64_t ods_cyclic_target_position(const ods_axis_values_t *values)
{
    return (int64_t)values->target_position + values->position_offset;
}

int64_t ods_cyclic_target_velocity(const ods_axis_values_t *values)
{
    return ods_velocity(values, values->target_velocity) + ods_velocity(values, values->velocity_offset);
}
