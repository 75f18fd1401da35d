/*
 * Limit switches, the home switch and software limits of an axis.
 */
#ifndef ODS_LIMITS_H
#define ODS_LIMITS_H

#include "ods_axis.h"

/* Bits of the digital inputs 60FDh (CiA 402). Those of the switches are the bits of their lines. */
#define ODS_LIMITS_LINES (ODS_LINE_LEFT | ODS_LINE_RIGHT)
#define ODS_LIMITS_SWITCHES (ODS_LIMITS_LINES | ODS_LINE_HOME)
#define ODS_LIMITS_GENERAL 0x00FF0000u

#define ODS_LIMITS_INVERTED 0x2Cu /* 2005h: bits that turn the polarity of a switch round */

/* Conditions that are a limit of one direction. */
#define ODS_LIMITS_POSITIVE (1u << ODS_CONDITION_LIMIT_SWITCH_POSITIVE | 1u << ODS_CONDITION_SOFTWARE_LIMIT_POSITIVE)
#define ODS_LIMITS_NEGATIVE (1u << ODS_CONDITION_LIMIT_SWITCH_NEGATIVE | 1u << ODS_CONDITION_SOFTWARE_LIMIT_NEGATIVE)

/* Which switches are active, as 2005h says how to read them. */
uint32_t ods_limits_switches(const ods_axis_t *axis);

/* Whether what is found there forbids to move that way. */
int ods_limits_hold(const ods_axis_t *axis, int64_t distance);

/* Conditions of the switches and the software limits that have been reached. */
uint32_t ods_limits_reached(const ods_axis_t *axis);

/* The position allowed that is nearest to a target. */
int32_t ods_limits_clamp(const ods_axis_t *axis, int64_t target);

/* Switches of the axis, and the general inputs of the module. */
static inline void ods_limits_sample(ods_node_t *node, ods_axis_t *axis)
{
    ods_axis_values_t *const values = axis->values;
    uint32_t inputs = node->common->general_inputs & ODS_LIMITS_GENERAL;
    if (((axis->answer.lines & ODS_LIMITS_SWITCHES) | (values->switch_parameters & ODS_LIMITS_INVERTED)) != 0u) {
        inputs |= ods_limits_switches(axis);
    }
    if (values->digital_inputs != inputs) {
        values->digital_inputs = inputs;
        ods_axis_changed(node, axis);
    }
}

/* Whether something forbids to move that way. A homing looks for its switches and is not held back. */
static inline int ods_limits_block(const ods_axis_t *axis, int64_t distance)
{
    const uint32_t found = (axis->values->digital_inputs & ODS_LIMITS_LINES) |
                           (axis->conditions & (ODS_LIMITS_POSITIVE | ODS_LIMITS_NEGATIVE));
    return (found != 0u) && ods_limits_hold(axis, distance);
}

/* Which limits have been reached in this tick. */
static inline void ods_limits_check(ods_axis_t *axis)
{
    const ods_axis_values_t *const values = axis->values;
    /* 607Dh is counted from the home position (manual, section 6.1.11). */
    const int64_t position = (int64_t)values->position_actual_value + values->home_offset_display;
    const int is_inside = (position >= values->software_position_limit_minimum) &&
                          (position <= values->software_position_limit_maximum) &&
                          ((values->digital_inputs & ODS_LIMITS_LINES) == 0u);
    axis->limits = is_inside ? 0u : ods_limits_reached(axis);
}

#endif
