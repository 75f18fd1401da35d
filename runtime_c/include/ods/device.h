/*
 * What the runtime has to know about a device: the one constant that a device is in C.
 *
 * The generator makes a `const ods_device_t` for each device; a node gets its address at init and looks up everything
 * in it. So two devices can run in one process, and no line of the runtime names a device.
 *
 * The caller provides the memory. For a device called NAME the generator writes
 *     NAME.h           all memory of a node in one struct, NAME_t, and NAME_init(); what an application includes
 *     NAME_device.h    the constant, and the device's own codes
 *     NAME_od.h        the struct of all values of its object dictionary, and names for the objects
 *
 * A table without rows is NULL with a count of 0: a device need not have axes, modes or a state machine. Rows stand in
 * the order of the specification where this matters: controlword commands are decoded and emergencies raised in it.
 */
#ifndef ODS_DEVICE_H
#define ODS_DEVICE_H

#include <stdint.h>

#include "ods/od.h"
#include "ods/vocabulary.h"

#ifdef __cplusplus
extern "C" {
#endif

#define ODS_NONE 0xFFu /* where a byte names a thing: there is none */
#define ODS_NOWHERE 0xFFFFu /* where an offset is expected: there is none */
#define ODS_ALL_AXES 0xFFu

/* A number among the values of an axis: its offset in the struct and its type (ODS_U16, ODS_U32 ...). */
typedef struct {
    uint16_t at;
    uint8_t type;
} ods_axis_field_t;

/* ---- network management ------------------------------------------------------------------------------------------ */

typedef struct {
    uint8_t state; /* ods_nmt_state_t, as the heartbeat carries it */
    uint8_t services; /* ODS_SERVICE_...: what runs in it */
} ods_nmt_state_row_t;

typedef struct {
    uint8_t command; /* ods_nmt_command_t, as the frame carries it */
    uint8_t state; /* where it leads */
} ods_nmt_command_row_t;

/* A value of error behaviour (1029h) and where an error leads with it. Values without a row change nothing. */
typedef struct {
    uint8_t value;
    uint8_t state; /* ods_nmt_state_t */
} ods_error_behaviour_row_t;

/* One row for each reason to show a pattern. The row of highest priority shows; it starts with its first phase. */
typedef struct {
    uint8_t led; /* ods_led_t */
    uint8_t when; /* ods_led_when_t */
    uint8_t priority;
    uint8_t steady; /* without phases: 1 on, 0 off */
    uint8_t first; /* its first phase in led_phases; they are ms, on and off in turn */
    uint8_t phases;
} ods_led_row_t;

/* ---- emergencies ------------------------------------------------------------------------------------------------- */

typedef struct {
    uint16_t code;
    uint8_t bytes[5];
    uint8_t axis_byte; /* which of `bytes` takes the number of the axis; ODS_NONE where it concerns the device */
    uint8_t error_register;
    uint8_t condition; /* ods_condition_t */
    uint8_t reaction; /* ods_reaction_t */
    uint8_t momentary; /* 1: shows in 1001h only while its frame is sent */
    uint8_t driver_flag; /* bit of the driver error flags that is set while the condition holds */
} ods_emergency_row_t;

/* ---- storing ----------------------------------------------------------------------------------------------------- */

/* What an entry with the effect of storing or restoring acts on. */
typedef struct {
    uint16_t index;
    uint16_t groups; /* storage groups, bit 1 << (group - 1) */
    uint8_t sub;
    uint8_t axis; /* only this axis, or ODS_ALL_AXES */
} ods_store_row_t;

/* ---- drive ------------------------------------------------------------------------------------------------------- */

typedef struct {
    int8_t code; /* in 6060h */
    uint8_t bit; /* in 6502h, ODS_NONE for no mode */
    uint16_t control; /* bits of the controlword that the mode obeys */
    uint16_t status; /* bits of the statusword that the mode sets; it leaves the others at 0 */
    uint16_t slow_down_ramp; /* offset of a deceleration (uint32_t) in the values of an axis, or ODS_NOWHERE */
} ods_mode_row_t;

/* The statusword tells a state by `value` under `mask`. */
typedef struct {
    uint16_t mask;
    uint16_t value;
    uint8_t state; /* ods_pds_state_t */
    uint8_t power; /* 1: the motor is powered */
} ods_pds_state_row_t;

/* A controlword is a command if it has `value` under `mask` and the bits of `edge` have just become 1. */
typedef struct {
    uint16_t mask;
    uint16_t value;
    uint16_t edge;
    uint8_t command; /* ods_pds_trigger_t */
} ods_pds_command_row_t;

/* A transition with several starts or triggers has a row for each pair of them. */
typedef struct {
    uint8_t from; /* ods_pds_state_t, ODS_NONE for power-on */
    uint8_t by; /* ods_pds_trigger_t */
    uint8_t to; /* ods_pds_state_t */
    uint8_t number;
} ods_pds_transition_row_t;

typedef enum {
    ODS_SWITCH_NONE,
    ODS_SWITCH_NEGATIVE_LIMIT,
    ODS_SWITCH_POSITIVE_LIMIT,
    ODS_SWITCH_HOME
} ods_switch_t;

#define ODS_HOMING_INDEX_PULSE 0x01u /* the position is that of the next index pulse */
#define ODS_HOMING_POWER 0x02u /* the axis must be in operation enabled */

typedef struct {
    int8_t method; /* in 6098h */
    int8_t direction; /* of the search while the switch is inactive: -1, 0, 1 */
    int8_t edge; /* direction of travel when the edge of the switch is taken: -1, 0, 1 */
    uint8_t reference; /* ods_switch_t: the switch that is looked for */
    uint8_t reverse_at; /* ods_switch_t: the switch that turns the search round */
    uint8_t flags;
} ods_homing_row_t;

/* The parameters of a SixPoint ramp. */
typedef enum {
    ODS_RAMP_V_START,
    ODS_RAMP_A1,
    ODS_RAMP_V1,
    ODS_RAMP_A2,
    ODS_RAMP_V_MAX,
    ODS_RAMP_D2,
    ODS_RAMP_D1,
    ODS_RAMP_V_STOP,
    ODS_RAMP_WAIT,
    ODS_RAMP_PARAMETERS
} ods_ramp_parameter_t;

typedef struct {
    uint8_t parameter; /* ods_ramp_parameter_t */
    ods_axis_field_t field;
} ods_ramp_row_t;

/* A value that the motor driver is told (ods_port_t.motor_set): its object in axis 0. Rows ascend. */
typedef struct {
    uint16_t index;
    ods_axis_field_t field;
} ods_motor_parameter_row_t;

/* ---- the device -------------------------------------------------------------------------------------------------- */

typedef struct {
    const ods_od_t *od;

    const char *name;
    uint32_t vendor_id;
    uint32_t product_code;
    uint32_t revision_number;
    const uint16_t *bit_rates; /* kbit/s, ascending */
    uint8_t bit_rate_count;
    uint8_t axes;
    uint8_t digital_inputs;
    uint8_t digital_outputs;
    uint8_t analog_inputs;
    uint8_t analog_outputs;

    uint8_t nmt_state_count;
    uint8_t nmt_command_count;
    uint8_t error_behaviour_count;
    uint8_t led_count;
    uint8_t emergency_count;
    uint8_t store_count;
    uint8_t mode_count;
    uint8_t pds_state_count;
    uint8_t pds_command_count;
    uint8_t pds_transition_count;
    uint8_t homing_count;
    uint8_t ramp_count;
    uint8_t motor_parameter_count;

    const ods_nmt_state_row_t *nmt_states;
    const ods_nmt_command_row_t *nmt_commands;
    const ods_error_behaviour_row_t *error_behaviours;
    const ods_led_row_t *leds;
    const uint16_t *led_phases;
    const ods_emergency_row_t *emergencies;
    const ods_store_row_t *stores;
    const ods_mode_row_t *modes;
    const ods_pds_state_row_t *pds_states;
    const ods_pds_command_row_t *pds_commands;
    const ods_pds_transition_row_t *pds_transitions;
    const ods_homing_row_t *homing_methods;
    const ods_ramp_row_t *ramp;
    const ods_motor_parameter_row_t *motor_parameters;
} ods_device_t;

#ifdef __cplusplus
}
#endif

#endif
