#include "ods_simulation.h"

#include <string.h>

#include "ods/vocabulary.h"

/* Figures of this simulation: no manual has them. A condition ends only when its cause has gone by some way. */
#define WARM 120 /* degrees Celsius: from here on the temperature warning */
#define HOT 150 /* degrees Celsius: from here on overtemperature */
#define COOLING 10 /* so many degrees below, they end */
#define SUPPLY 24000 /* mV */
#define LOW_SUPPLY 7000 /* mV: below it undervoltage */
#define GOOD_SUPPLY 7500 /* mV: from here on none */
#define ROOM_TEMPERATURE 25
#define ABSOLUTE_ZERO (-273)
#define HIGHEST_TEMPERATURE 1000
#define HIGHEST_SUPPLY 100000
#define MICROSTEPS_PER_REVOLUTION 51200 /* of a motor with 200 full steps, at 256 microsteps for each of them */

#define IDLE_LOAD 1023
#define PWM_MAX 255u
#define PWM_PPS 1000u /* for each step of the PWM scale */

static const struct {
    const char *name;
    int32_t low;
    int32_t high;
    int32_t initial;
} inputs[ODS_SIMULATION_INPUTS] = {
    [ODS_SIMULATION_LEFT] = { "left", 0, 1, 0 },
    [ODS_SIMULATION_RIGHT] = { "right", 0, 1, 0 },
    [ODS_SIMULATION_HOME] = { "home", 0, 1, 0 },
    [ODS_SIMULATION_LEFT_AT] = { "left_at", INT32_MIN, INT32_MAX, 0 },
    [ODS_SIMULATION_RIGHT_AT] = { "right_at", INT32_MIN, INT32_MAX, 0 },
    [ODS_SIMULATION_HOME_FROM] = { "home_from", INT32_MIN, INT32_MAX, 0 },
    [ODS_SIMULATION_HOME_TO] = { "home_to", INT32_MIN, INT32_MAX, 0 },
    [ODS_SIMULATION_HYSTERESIS] = { "hysteresis", 0, INT32_MAX, 0 },
    [ODS_SIMULATION_LOAD] = { "load", 0, IDLE_LOAD, 0 },
    [ODS_SIMULATION_BLOCKED] = { "blocked", 0, 1, 0 },
    [ODS_SIMULATION_TEMPERATURE] = { "temperature", ABSOLUTE_ZERO, HIGHEST_TEMPERATURE, ROOM_TEMPERATURE },
    [ODS_SIMULATION_REVOLUTION] = { "revolution", 1, INT32_MAX, MICROSTEPS_PER_REVOLUTION },
    [ODS_SIMULATION_INCREMENTS] = { "increments", 0, INT32_MAX, 0 },
    [ODS_SIMULATION_SHAFT] = { "shaft", INT32_MIN, INT32_MAX, 0 },
    [ODS_SIMULATION_SUPPLY] = { "supply", 0, HIGHEST_SUPPLY, SUPPLY },
};

/* ---- what the hardware has to say -------------------------------------------------------------------------------- */

static int has(const ods_simulation_t *axis, ods_simulation_input_t input)
{
    return ((axis->is_set >> input) & 1u) != 0u;
}

/*
 * A switch at a position: the shaft is so many microsteps outside of it, or inside if that is not positive. Once active
 * it takes the hysteresis to release it.
 */
static void reach(ods_simulation_t *axis, uint8_t line, int64_t outside)
{
    const int was = (axis->switches & line) != 0u;

    if (outside <= (was ? axis->inputs[ODS_SIMULATION_HYSTERESIS] : 0)) {
        axis->switches |= line;
    } else {
        axis->switches &= (uint8_t)~line;
    }
}

static void look_at_switches(ods_simulation_t *axis)
{
    const int32_t *const at = axis->inputs;

    if (has(axis, ODS_SIMULATION_LEFT_AT)) {
        reach(axis, ODS_LINE_LEFT, axis->shaft - at[ODS_SIMULATION_LEFT_AT]);
    }
    if (has(axis, ODS_SIMULATION_RIGHT_AT)) {
        reach(axis, ODS_LINE_RIGHT, at[ODS_SIMULATION_RIGHT_AT] - axis->shaft);
    }
    if (has(axis, ODS_SIMULATION_HOME_FROM) && has(axis, ODS_SIMULATION_HOME_TO)) {
        const int64_t before = at[ODS_SIMULATION_HOME_FROM] - axis->shaft;
        const int64_t behind = axis->shaft - at[ODS_SIMULATION_HOME_TO];
        reach(axis, ODS_LINE_HOME, (before > behind) ? before : behind);
    }
}

/* The lines of the switches: by position or by hand. */
static uint32_t switches(const ods_simulation_t *axis)
{
    return axis->switches | (axis->inputs[ODS_SIMULATION_LEFT] ? ODS_LINE_LEFT : 0u) |
           (axis->inputs[ODS_SIMULATION_RIGHT] ? ODS_LINE_RIGHT : 0u) |
           (axis->inputs[ODS_SIMULATION_HOME] ? ODS_LINE_HOME : 0u);
}

/* What the encoder says of the shaft: its count, rounded down, and its index, which lasts about as long as a count. */
static uint32_t look_at_encoder(ods_simulation_t *axis)
{
    const int32_t increments = axis->inputs[ODS_SIMULATION_INCREMENTS];
    const int32_t revolution = axis->inputs[ODS_SIMULATION_REVOLUTION];
    int64_t turns = axis->shaft / revolution;
    int64_t rest = axis->shaft % revolution;

    if (rest < 0) {
        rest += revolution;
        turns--;
    }
    axis->answer.encoder =
        (int32_t)((uint32_t)turns * (uint32_t)increments + (uint32_t)(rest * increments / revolution));
    return ((increments > 0) && ((rest == 0) || (rest < revolution / increments))) ? ODS_LINE_INDEX : 0u;
}

static void judge(ods_simulation_t *axis, ods_condition_t condition, int begins, int ends)
{
    const uint32_t bit = 1u << condition;

    if (begins) {
        axis->answer.faults |= bit;
    } else if (ends) {
        axis->answer.faults &= ~bit;
    }
}

static void look(ods_simulation_t *axis)
{
    const int32_t temperature = axis->inputs[ODS_SIMULATION_TEMPERATURE];
    const int32_t supply = axis->inputs[ODS_SIMULATION_SUPPLY];

    look_at_switches(axis);
    axis->answer.lines = (uint8_t)(switches(axis) | look_at_encoder(axis));
    judge(axis, ODS_CONDITION_TEMPERATURE_WARNING, temperature >= WARM, temperature <= WARM - COOLING);
    judge(axis, ODS_CONDITION_OVERTEMPERATURE, temperature >= HOT, temperature <= HOT - COOLING);
    judge(axis, ODS_CONDITION_UNDERVOLTAGE, supply < LOW_SUPPLY, supply >= GOOD_SUPPLY);
}

/* What the driver measures in a tick at such a velocity. */
static void measure(ods_simulation_t *axis, int32_t velocity)
{
    const int is_blocked = axis->inputs[ODS_SIMULATION_BLOCKED];
    const uint32_t pwm = ((velocity < 0) ? 0u - (uint32_t)velocity : (uint32_t)velocity) / PWM_PPS;
    ods_motor_answer_t *const answer = &axis->answer;

    answer->velocity = is_blocked ? 0 : velocity;
    if (velocity != 0) {
        answer->load = is_blocked ? 0u : (uint16_t)(IDLE_LOAD - axis->inputs[ODS_SIMULATION_LOAD]);
    }
    answer->pwm_scale = 0;
    if ((axis->driver & ODS_DRIVER_STEALTH_CHOP) != 0u) {
        answer->pwm_scale = (uint8_t)((pwm < PWM_MAX) ? pwm : PWM_MAX);
    }
}

/* ---- what happens to it ------------------------------------------------------------------------------------------ */

void ods_simulation_init(ods_simulation_t *axis)
{
    memset(axis, 0, sizeof(*axis));
    for (unsigned input = 0; input < (unsigned)ODS_SIMULATION_INPUTS; input++) {
        axis->inputs[input] = inputs[input].initial;
    }
}

void ods_simulation_power_on(ods_simulation_t *axis)
{
    axis->current = 0;
    axis->driver = 0;
    axis->answer.velocity = 0;
    axis->answer.load = 0;
    axis->answer.pwm_scale = 0;
}

ods_simulation_input_t ods_simulation_find(const char *name)
{
    unsigned input = 0;

    while ((input < (unsigned)ODS_SIMULATION_INPUTS) && (strcmp(inputs[input].name, name) != 0)) {
        input++;
    }
    return (ods_simulation_input_t)input;
}

int ods_simulation_set(ods_simulation_t *axis, ods_simulation_input_t input, int32_t value)
{
    if ((value < inputs[input].low) || (value > inputs[input].high)) {
        return 0;
    }
    axis->inputs[input] = value;
    axis->is_set |= 1u << input;
    if (input == ODS_SIMULATION_SHAFT) {
        axis->shaft = value;
    }
    look(axis);
    return 1;
}

void ods_simulation_output(ods_simulation_t *axis, ods_output_t output, uint32_t value)
{
    if (output == ODS_OUTPUT_CURRENT) {
        axis->current = value;
    } else if (output == ODS_OUTPUT_DRIVER) {
        axis->driver = value;
    } /* nothing here depends on the others */
}

void ods_simulation_motor(ods_simulation_t *axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer)
{
    if ((axis->current != 0u) && (axis->inputs[ODS_SIMULATION_BLOCKED] == 0)) {
        axis->shaft += demand->steps;
    }
    measure(axis, demand->velocity);
    look(axis);
    *answer = axis->answer;
}
