#include "ods_limits.h"

/*
 * Bits of the switch parameters 2005h: 0 and 1 take the left and the right switch out of use, 2 and 3 turn their
 * polarity round, 4 and 5 do so for the home switch. The shifts lead to the bits of the lines.
 */
#define UNUSED(parameters) (((parameters)&ODS_LIMITS_LINES) | (((parameters) >> 2) & ODS_LINE_HOME))
#define INVERTED(parameters) ((((parameters) >> 2) & ODS_LIMITS_LINES) | (((parameters) >> 3) & ODS_LINE_HOME))

static int is_homing(const ods_axis_t *axis)
{
    return axis->values->modes_of_operation_display == (int8_t)ODS_MODE_HOMING;
}

uint32_t ods_limits_switches(const ods_axis_t *axis)
{
    const uint32_t parameters = axis->values->switch_parameters;
    return (axis->answer.lines ^ INVERTED(parameters)) & ~UNUSED(parameters) & ODS_LIMITS_SWITCHES;
}

int ods_limits_hold(const ods_axis_t *axis, int64_t distance)
{
    if ((distance == 0) || is_homing(axis)) {
        return 0;
    }
    const uint32_t line = (distance > 0) ? ODS_LINE_RIGHT : ODS_LINE_LEFT;
    const uint32_t conditions = (distance > 0) ? ODS_LIMITS_POSITIVE : ODS_LIMITS_NEGATIVE;
    return ((axis->values->digital_inputs & line) | (axis->conditions & conditions)) != 0u;
}

static int64_t lowest(const ods_axis_values_t *values)
{
    return (int64_t)values->software_position_limit_minimum - values->home_offset_display;
}

static int64_t highest(const ods_axis_values_t *values)
{
    return (int64_t)values->software_position_limit_maximum - values->home_offset_display;
}

uint32_t ods_limits_reached(const ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    uint32_t reached = 0;

    if (is_homing(axis)) {
        return 0;
    }
    if (values->position_actual_value > highest(values)) {
        reached |= 1u << ODS_CONDITION_SOFTWARE_LIMIT_POSITIVE;
    }
    if (values->position_actual_value < lowest(values)) {
        reached |= 1u << ODS_CONDITION_SOFTWARE_LIMIT_NEGATIVE;
    }
    if ((values->digital_inputs & ODS_LINE_RIGHT) != 0u) {
        reached |= 1u << ODS_CONDITION_LIMIT_SWITCH_POSITIVE;
    }
    if ((values->digital_inputs & ODS_LINE_LEFT) != 0u) {
        reached |= 1u << ODS_CONDITION_LIMIT_SWITCH_NEGATIVE;
    }
    return reached;
}

static int64_t within(int64_t number, int64_t low, int64_t high)
{
    const int64_t raised = (number < low) ? low : number;
    return (raised > high) ? high : raised;
}

int32_t ods_limits_clamp(const ods_axis_t *axis, int64_t target)
{
    const int64_t low = within(lowest(axis->values), INT32_MIN, INT64_MAX);
    const int64_t high = within(highest(axis->values), INT32_MIN, INT32_MAX);
    return (int32_t)within(target, low, high);
}
