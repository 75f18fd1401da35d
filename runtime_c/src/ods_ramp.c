#include "ods_ramp.h"

/* Further than any distance, and two of them can be added. */
#define FAR (INT64_C(1) << 61)
/* The way to stop from a speed below it is never that far. */
#define PLAIN (INT64_C(1) << 31)

static inline int64_t smaller(int64_t a, int64_t b)
{
    return (a < b) ? a : b;
}

static inline int64_t larger(int64_t a, int64_t b)
{
    return (a > b) ? a : b;
}

int64_t ods_ramp_slow_down(int64_t velocity, int64_t deceleration)
{
    if (deceleration == 0) {
        return 0;
    }
    return (velocity > 0) ? larger(velocity - deceleration, 0) : smaller(velocity + deceleration, 0);
}

int64_t ods_ramp_turn(int64_t velocity, int64_t target, int64_t acceleration, int64_t v_start, int64_t v_stop)
{
    const int64_t sign = ((target < 0) || ((target == 0) && (velocity < 0))) ? -1 : 1;
    const int64_t v = velocity * sign;
    const int64_t goal = target * sign;
    int64_t next;

    if ((v < 0) || (goal == 0)) {
        const int64_t speed = (v < 0) ? -v : v;
        const int64_t slower =
            ((speed <= v_stop) || (acceleration == 0)) ? 0 : larger(speed - acceleration, v_stop);
        next = (v < 0) ? -slower : slower;
    } else if (v < goal) {
        next = (acceleration == 0) ? v : smaller((v < v_start) ? v_start : v + acceleration, goal);
    } else {
        next = (acceleration == 0) ? goal : larger(v - acceleration, goal);
    }
    return next * sign;
}

/* A tick nearer to standstill. A speed at which the slope changes is not jumped over. */
static int64_t slower(const ods_ramp_t *ramp, int64_t speed)
{
    int64_t deceleration = ramp->d2;
    int64_t end = larger(ramp->v1, ramp->v_stop);

    if (speed <= ramp->v_stop) {
        return 0;
    }
    if ((ramp->v1 != 0) && (speed <= ramp->v1)) {
        deceleration = ramp->d1;
        end = ramp->v_stop;
    }
    return (deceleration == 0) ? 0 : larger(speed - deceleration, end);
}

/* A tick nearer to the cruising speed, or back to it. */
static int64_t faster(const ods_ramp_t *ramp, int64_t speed)
{
    return (speed > ramp->v_max) ? larger(slower(ramp, speed), ramp->v_max) : ods_ramp_faster(ramp, speed);
}

/* Ticks from a speed down to the end of a slope. */
static inline int64_t ticks_of(int64_t speed, int64_t deceleration, int64_t end)
{
    return (speed - end + deceleration - 1) / deceleration;
}

/* The sum of the speeds in these ticks. */
static inline int64_t way(int64_t ticks, int64_t speed, int64_t deceleration, int64_t end)
{
    if ((speed >= PLAIN) && (ticks > FAR / speed)) {
        return FAR;
    }
    return (ticks - 1) * speed - (ticks - 1) * ticks / 2 * deceleration + end;
}

/*
 * The sum of all speeds that slower() leads through. `growth` becomes what it grows by at least if the first of them is
 * higher by 1: so do the others of its slope, and where they fill it exactly there is one more of them.
 */
static inline int64_t measure_way(const ods_ramp_t *ramp, int64_t speed, int64_t *growth)
{
    int64_t deceleration = ramp->d2;
    int64_t end = ramp->v_stop;
    int64_t rest = 0;

    *growth = 1;
    if (speed <= end) {
        return 0;
    }
    if ((ramp->v1 != 0) && (speed <= ramp->v1)) {
        deceleration = ramp->d1;
    } else if (ramp->v1 > end) {
        end = ramp->v1;
        rest = ((deceleration == 0) || (ramp->d1 == 0))
                   ? 0
                   : way(ticks_of(end, ramp->d1, ramp->v_stop), end, ramp->d1, ramp->v_stop);
    }
    if (deceleration == 0) {
        return 0;
    }
    const int64_t ticks = ticks_of(speed, deceleration, end);
    if (ticks > 1) {
        *growth = (ticks * deceleration == speed - end) ? ticks + end : ticks - 1;
    }
    return way(ticks, speed, deceleration, end) + rest;
}

static int64_t way_to_stop(const ods_ramp_t *ramp, int64_t speed)
{
    int64_t growth;
    return measure_way(ramp, speed, &growth);
}

/* Whether a tick at this speed leaves way enough to stop. */
static int fits(const ods_ramp_t *ramp, int64_t speed, int64_t distance)
{
    return speed + way_to_stop(ramp, speed) <= distance;
}

/* The highest speed that fits, from one that does to one that does not. It is mostly the first, or near to it. */
static int64_t fastest(const ods_ramp_t *ramp, int64_t low, int64_t high, int64_t distance)
{
    int64_t step = 1;
    while ((low + step < high) && fits(ramp, low + step, distance)) {
        low += step;
        step *= 2;
    }
    high = smaller(high, low + step);
    while (high - low > 1) {
        const int64_t middle = (low + high) / 2;
        if (fits(ramp, middle, distance)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/*
 * Whether the lower speed is the one to take, as it is in nearly every tick of a braking: the present one does not fit,
 * and neither does the next one above the lower. Says no where it is not quick to tell.
 *
 * The way to stop from the present speed is the lower one and the way to stop from that. It grows with the speed,
 * unless a slope stops at once.
 */
static int is_lower(const ods_ramp_t *ramp, int64_t speed, int64_t distance)
{
    int64_t growth;
    if ((ramp->d2 == 0) || ((ramp->v1 != 0) && (ramp->d1 == 0)) || (speed > ramp->v_max)) {
        return 0;
    }
    const int64_t left = distance - measure_way(ramp, speed, &growth);
    return (left < speed) && (left < growth);
}

int64_t ods_ramp_advance(const ods_ramp_t *ramp, int64_t velocity, int64_t distance, int *arrives)
{
    const int64_t sign = ((distance < 0) || ((distance == 0) && (velocity < 0))) ? -1 : 1;
    const int64_t v = velocity * sign;
    const int64_t d = distance * sign;

    *arrives = 0;
    if (v < 0) {
        return -slower(ramp, -v) * sign;
    }
    const int64_t low = slower(ramp, v);
    if ((d > ramp->v_max) && is_lower(ramp, v, d)) {
        return low * sign;
    }
    const int64_t high = faster(ramp, v);
    if ((low <= d) && (d <= high) && (slower(ramp, d) == 0)) {
        *arrives = 1;
        return 0;
    }
    if (fits(ramp, high, d)) {
        return high * sign;
    }
    if (fits(ramp, low, d)) {
        return fastest(ramp, low, high, d) * sign;
    }
    return low * sign;
}

/*
 * A speed of which the axis can stop in time lets it stop from a lower one on the same slope, too. So the highest ones
 * of both slopes tell.
 */
int64_t ods_ramp_far(const ods_ramp_t *ramp)
{
    const int64_t low = smaller(ramp->v1, ramp->v_max);
    const int64_t far = larger(ramp->v_max + way_to_stop(ramp, ramp->v_max), low + way_to_stop(ramp, low));
    return far + 1;
}
