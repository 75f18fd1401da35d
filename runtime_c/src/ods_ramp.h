/*
 * The ramp generator: how fast an axis is one tick later.
 *
 * Pure functions. Velocities count 1/1000 microstep per second, distances 1/1,000,000 microstep, accelerations 1/1000
 * microstep per second and tick: a tick adds them up as they are (see ods_units.h).
 */
#ifndef ODS_RAMP_H
#define ODS_RAMP_H

#include <stdint.h>

/* The parameters of a six point ramp (section 1.5 of the manuals), none of them negative. */
typedef struct {
    int64_t v_start;
    int64_t a1;
    int64_t v1; /* 0: a trapezoid of v_start, a2, v_max, d2 and v_stop */
    int64_t a2;
    int64_t v_max;
    int64_t d2;
    int64_t d1;
    int64_t v_stop;
} ods_ramp_t;

/* Towards standstill on a single slope. A deceleration of 0 stops at once. */
int64_t ods_ramp_slow_down(int64_t velocity, int64_t deceleration);

/*
 * Towards a target velocity on a trapezoid whose slopes are equal (profile velocity mode). A change of direction leads
 * through standstill. An acceleration of 0 never starts, and slows down at once.
 */
int64_t ods_ramp_turn(int64_t velocity, int64_t target, int64_t acceleration, int64_t v_start, int64_t v_stop);

/*
 * Towards a target on a six point ramp: the velocity. `arrives` becomes 1 if the target is reached in this tick, in
 * which the axis makes just the distance, and stands; else 0. It is as fast as the ramp allows from where the target
 * can still be reached without going past it. If that is nowhere, it slows down, stops and comes back.
 */
int64_t ods_ramp_advance(const ods_ramp_t *ramp, int64_t velocity, int64_t distance, int *arrives);

/* A distance to the target from which on ods_ramp_faster() is the velocity, for any speed up to v_max; not 0. */
int64_t ods_ramp_far(const ods_ramp_t *ramp);

/* A tick nearer to the cruising speed, from a speed that is not above it. */
static inline int64_t ods_ramp_faster(const ods_ramp_t *ramp, int64_t speed)
{
    int64_t acceleration = ramp->a2;
    int64_t end = ramp->v_max;

    if (speed < ramp->v1) {
        acceleration = ramp->a1;
        end = (ramp->v1 < end) ? ramp->v1 : end;
    }
    if (acceleration == 0) {
        return speed;
    }
    if (speed < ramp->v_start) {
        return (ramp->v_start < ramp->v_max) ? ramp->v_start : ramp->v_max;
    }
    return (speed + acceleration < end) ? speed + acceleration : end;
}

#endif
