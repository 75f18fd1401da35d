/*
 * Velocities and accelerations as a tick adds them up.
 *
 * Inside an axis a velocity counts 1/1000 microstep per second, a position 1/1,000,000 microstep. So in a tick of 1 ms
 * a velocity is added to the position as it is, and an acceleration in microsteps per second squared to the velocity.
 * On the bus the numbers have the unit that 208Ch selects. Divisions truncate.
 */
#ifndef ODS_UNITS_H
#define ODS_UNITS_H

#include "ods/values.h"
#include "ods/vocabulary.h"

#define ODS_PER_MICROSTEP 1000000
#define ODS_PER_PPS 1000

static inline int ods_units_are_internal(const ods_axis_values_t *values)
{
    return values->velocity_dimension_index == ODS_VELOCITY_INTERNAL_CODE;
}

/* A velocity on the bus, in 1/1000 microstep per second. */
static inline int64_t ods_velocity(const ods_axis_values_t *values, int64_t number)
{
    const int64_t velocity = number * ODS_PER_PPS;
    return ods_units_are_internal(values)
               ? velocity * ODS_VELOCITY_INTERNAL_NUMERATOR / ODS_VELOCITY_INTERNAL_DENOMINATOR
               : velocity;
}

/* An acceleration on the bus, in 1/1000 microstep per second and tick. */
static inline int64_t ods_acceleration(const ods_axis_values_t *values, uint32_t number)
{
    return ods_units_are_internal(values)
               ? (int64_t)number * ODS_ACCELERATION_INTERNAL_NUMERATOR / ODS_ACCELERATION_INTERNAL_DENOMINATOR
               : (int64_t)number;
}

/* How the bus says a velocity in 1/1000 microstep per second; in two parts, for whole it might overflow. */
static inline int32_t ods_velocity_number(const ods_axis_values_t *values, int64_t velocity)
{
    if (!ods_units_are_internal(values)) {
        return (int32_t)(velocity / ODS_PER_PPS);
    }
    const int64_t unit = INT64_C(1) * ODS_PER_PPS * ODS_VELOCITY_INTERNAL_NUMERATOR;
    return (int32_t)(velocity / unit * ODS_VELOCITY_INTERNAL_DENOMINATOR +
                     velocity % unit * ODS_VELOCITY_INTERNAL_DENOMINATOR / unit);
}

/* What 208Eh says of the unit that 208Ch selects. */
static inline uint8_t ods_acceleration_index(const ods_axis_values_t *values)
{
    return ods_units_are_internal(values) ? ODS_ACCELERATION_INTERNAL_CODE : ODS_ACCELERATION_PPS_CODE;
}

#endif
