#include "ods_encoder.h"

#include "ods_units.h"

#define ACTIVE_HIGH 0x01u /* 200Bh:01 */
#define REVERSED 0x01u /* 200Bh:02 */
#define LATCH_ONCE 0x01u /* 200Fh:01 */
#define LATCH_EACH 0x02u

void ods_encoder_reset(ods_axis_t *axis)
{
    axis->encoder.count = axis->answer.encoder;
}

/* Microsteps that 608Fh:01 increments stand for. */
static int64_t per_turn(const ods_axis_values_t *values)
{
    return ((int64_t)values->fullstep_resolution << values->microstep_resolution) * values->encoder_motor_revolutions;
}

/* Positions wrap. */
static int32_t wrapped(int64_t number)
{
    return (int32_t)(uint32_t)number;
}

static void count(ods_axis_t *axis, int32_t increments)
{
    ods_encoder_t *const encoder = &axis->encoder;
    const int64_t each = axis->values->encoder_increments;
    const int64_t turn = per_turn(axis->values);

    encoder->increments += increments;
    /* Whole revolutions go into the origin, so that the count of increments stays small. */
    const int64_t turns = encoder->increments / each;
    encoder->increments -= turns * each;
    encoder->origin = wrapped(encoder->origin + turns * turn);
    encoder->position = wrapped(encoder->origin + encoder->increments * turn / each);
}

/* The index begins: latch the positions if 200Fh says so. */
static void find_pulse(ods_axis_t *axis)
{
    ods_axis_values_t *const values = axis->values;
    const uint32_t is_high = (axis->answer.lines & ODS_LINE_INDEX) != 0u;
    const uint8_t is_index = is_high == (values->encoder_polarity & ACTIVE_HIGH);

    axis->encoder.has_pulse = (is_index != 0u) && (axis->encoder.is_index == 0u);
    axis->encoder.is_index = is_index;
    if ((axis->encoder.has_pulse != 0u) && ((values->encoder_latch_mode & (LATCH_ONCE | LATCH_EACH)) != 0u)) {
        values->latched_internal_position = axis->demand;
        values->latched_encoder_position = axis->encoder.position;
        values->encoder_latch_mode &= (uint8_t)~LATCH_ONCE;
    }
}

void ods_encoder_sample(ods_axis_t *axis)
{
    const int32_t turned = wrapped((int64_t)axis->answer.encoder - axis->encoder.count);
    const int32_t before = axis->encoder.position;

    axis->encoder.count = axis->answer.encoder;
    if (ods_encoder_is_used(axis)) {
        count(axis, ((axis->values->encoder_direction & REVERSED) != 0u) ? wrapped(-(int64_t)turned) : turned);
    }
    axis->encoder.velocity = wrapped((int64_t)axis->encoder.position - before) * (int64_t)ODS_PER_MICROSTEP;
    find_pulse(axis);
}
