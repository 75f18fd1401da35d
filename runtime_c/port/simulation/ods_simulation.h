/*
 * Simulated hardware of an axis: a motor without mass that makes every step it is told, with limit and home switches,
 * an encoder, a load, a temperature and a supply, behind the callback `motor` of a port.
 *
 *     ods_simulation_t axes[AXES];                  each after ods_simulation_init()
 *     output:  ods_simulation_output(&axes[channel], output, value);
 *     motor:   ods_simulation_motor(&axes[axis], demand, answer);
 *
 * What a hand does to it is an input: ods_simulation_set(), and ods_node_motor() with the answer.
 *
 * The shaft and all inputs are the bench's: they stay what they are when the node is reset or its power goes. Nothing
 * happens between two calls, so what a shaft passes by within a tick nobody sees.
 */
#ifndef ODS_SIMULATION_H
#define ODS_SIMULATION_H

#include <stdint.h>

#include "ods/port.h"

/* What can be set. Positions are those of the shaft, in microsteps; where none was set there is no such switch. */
typedef enum {
    ODS_SIMULATION_LEFT, /* 1: somebody presses the switch; so the next two */
    ODS_SIMULATION_RIGHT,
    ODS_SIMULATION_HOME,
    ODS_SIMULATION_LEFT_AT, /* the switch is active here and to the left of it */
    ODS_SIMULATION_RIGHT_AT, /* the switch is active here and to the right of it */
    ODS_SIMULATION_HOME_FROM, /* the switch is active from here */
    ODS_SIMULATION_HOME_TO, /* up to here */
    ODS_SIMULATION_HYSTERESIS, /* so far outside a switch has to be before it is released */
    ODS_SIMULATION_LOAD, /* what takes so much away from the load value of a moving motor, which is 1023 when idle */
    ODS_SIMULATION_BLOCKED, /* 1: the shaft is held */
    ODS_SIMULATION_TEMPERATURE, /* of the driver, in degrees Celsius */
    ODS_SIMULATION_REVOLUTION, /* microsteps of a revolution of the shaft */
    ODS_SIMULATION_INCREMENTS, /* of the encoder in a revolution; 0: there is none */
    ODS_SIMULATION_SHAFT, /* turns the shaft to this position */
    ODS_SIMULATION_AXIS_INPUTS,
    ODS_SIMULATION_SUPPLY = ODS_SIMULATION_AXIS_INPUTS, /* of the motor, in mV; all axes of a module have the same */
    ODS_SIMULATION_INPUTS
} ods_simulation_input_t;

/* An axis. `shaft` and `answer` are there to be read, the rest is for the functions below alone. */
typedef struct {
    int64_t shaft; /* its position in microsteps */
    int32_t inputs[ODS_SIMULATION_INPUTS];
    uint32_t is_set; /* bit 1 << ods_simulation_input_t */
    uint32_t current; /* as last put out */
    uint32_t driver; /* ODS_DRIVER_..., as last put out */
    uint8_t switches; /* ODS_LINE_...: switches at positions that the shaft has reached and not left */
    ods_motor_answer_t answer; /* what it has to say */
} ods_simulation_t;

/* A motor at rest at position 0, cold, supplied, without switches and encoder. */
void ods_simulation_init(ods_simulation_t *axis);

/* The module is powered: nothing is put out any more, and the driver has not measured anything yet. */
void ods_simulation_power_on(ods_simulation_t *axis);

/* The input of a name such as `left_at`; ODS_SIMULATION_INPUTS if there is none. */
ods_simulation_input_t ods_simulation_find(const char *name);

/* Set an input. Returns 0, and does nothing, if the value is out of its range. */
int ods_simulation_set(ods_simulation_t *axis, ods_simulation_input_t input, int32_t value);

/* An output of the axis has changed. */
void ods_simulation_output(ods_simulation_t *axis, ods_output_t output, uint32_t value);

/* A tick is over. */
void ods_simulation_motor(ods_simulation_t *axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer);

#endif
