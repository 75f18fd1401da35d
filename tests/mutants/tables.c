/*
 * The tables of a device in memory that can be written, and where each of their values lies.
 *
 * It takes the place of the generated files, and is compiled for a device by
 *     -DDEVICE_HEADER='"x_device.h"' -DDEVICE_TABLES='"x_device.c"' -DOD_TABLES='"x_od.c"' -DDEVICE=x_device -DOD=x_od
 *     -DABORT_CODES=x_abort_codes
 */
#include <stddef.h>
#include <stdint.h>

#include "ods/device.h"

#define const
#include OD_TABLES
#include DEVICE_TABLES
#undef const

/* A column of a table: `each` values of `size` octets in each row, `rows` rows that are `stride` octets apart. */
typedef struct {
    const char *name;
    void *at;
    uint32_t rows;
    uint32_t stride;
    uint32_t each;
    uint32_t size;
} column_t;

#define ROWS(table) (uint32_t)(sizeof(table) / sizeof((table)[0]))
#define LIST(table)                                                           \
    {                                                                         \
#table, table, ROWS(table), sizeof((table)[0]), 1, sizeof((table)[0]) \
    }
#define COLUMN(table, member)                                                                                 \
    {                                                                                                         \
#table "." #member, &(table)[0].member, ROWS(table), sizeof((table)[0]), 1, sizeof((table)[0].member) \
    }
#define COLUMNS(table, member)                   \
    {                                            \
#table "." #member,                      \
            (table)[0].member,                   \
                    ROWS(table),                 \
                    sizeof((table)[0]),          \
                    ROWS((table)[0].member),     \
                    sizeof((table)[0].member[0]) \
    }
#define VALUE(constant, member)                                                                      \
    {                                                                                                \
#constant "." #member, &(constant).member, 1, sizeof(constant), 1, sizeof((constant).member) \
    }
#define VALUES(constant, member)         \
    {                                    \
#constant "." #member,           \
            (constant).member,           \
            1,                           \
            sizeof(constant),            \
            ROWS((constant).member),     \
            sizeof((constant).member[0]) \
    }

#define od OD
#define device DEVICE
#define abort_codes ABORT_CODES

extern column_t mutant_columns[];
column_t mutant_columns[] = {
    LIST(maps),
    COLUMN(chunks, entry),
    COLUMNS(chunks, first),
    COLUMN(folds, entry),
    COLUMN(folds, first),
    COLUMN(folds, shift),
    COLUMN(folds, each),
    COLUMN(folds, groups),
    COLUMN(folds, subs),
    COLUMN(entries, at),
    COLUMN(entries, kind),
    COLUMN(entries, rule),
    LIST(bases),
    LIST(words),
    COLUMN(texts, at),
    COLUMN(texts, length),
    COLUMN(rules, first),
    COLUMN(rules, intervals),
    COLUMN(rules, flags),
    COLUMN(rules, states),
    COLUMN(rules, group),
    COLUMN(rules, effect),
    COLUMN(intervals, low),
    COLUMN(intervals, high),
    LIST(other_cob_ids),
    COLUMN(node_ids, at),
    COLUMN(node_ids, kind),
    COLUMN(areas, first),
    COLUMN(areas, last),
    COLUMN(areas, stride),
    VALUE(od, layout),
    VALUE(od, values_size),
    VALUE(od, buffer_size),
    VALUE(od, communication_entries),
    VALUES(od, scope_entries),
    VALUES(od, scope_instances),
    VALUES(od, scope_size),
    VALUE(od, axis_rpdos),
    VALUE(od, axis_tpdos),
    VALUE(od, node_id_count),
    VALUE(od, area_count),
    VALUE(od, max_mapped),
    VALUES(od, owners),
    VALUES(od, map_of),
    { "device_defaults", &device_defaults, 1, sizeof(device_defaults), 1, sizeof(device_defaults) },
    { "axis_defaults", &axis_defaults, 1, sizeof(axis_defaults), 1, sizeof(axis_defaults) },
    LIST(rpdo_defaults),
    LIST(tpdo_defaults),
    VALUE(device, vendor_id),
    VALUE(device, product_code),
    VALUE(device, revision_number),
    VALUE(device, bit_rate_count),
    VALUE(device, axes),
    VALUE(device, digital_inputs),
    VALUE(device, digital_outputs),
    VALUE(device, analog_inputs),
    VALUE(device, analog_outputs),
    VALUE(device, nmt_state_count),
    VALUE(device, nmt_command_count),
    VALUE(device, error_behaviour_count),
    VALUE(device, led_count),
    VALUE(device, emergency_count),
    VALUE(device, store_count),
    VALUE(device, mode_count),
    VALUE(device, pds_state_count),
    VALUE(device, pds_command_count),
    VALUE(device, pds_transition_count),
    VALUE(device, homing_count),
    VALUE(device, ramp_count),
    VALUE(device, motor_parameter_count),
    LIST(bit_rates),
    COLUMN(nmt_states, state),
    COLUMN(nmt_states, services),
    COLUMN(nmt_commands, command),
    COLUMN(nmt_commands, state),
    COLUMN(error_behaviours, value),
    COLUMN(error_behaviours, state),
    COLUMN(leds, led),
    COLUMN(leds, when),
    COLUMN(leds, priority),
    COLUMN(leds, steady),
    COLUMN(leds, first),
    COLUMN(leds, phases),
    LIST(led_phases),
    COLUMN(emergencies, code),
    COLUMNS(emergencies, bytes),
    COLUMN(emergencies, axis_byte),
    COLUMN(emergencies, error_register),
    COLUMN(emergencies, condition),
    COLUMN(emergencies, reaction),
    COLUMN(emergencies, momentary),
    COLUMN(emergencies, driver_flag),
    COLUMN(stores, index),
    COLUMN(stores, groups),
    COLUMN(stores, sub),
    COLUMN(stores, axis),
    COLUMN(modes, code),
    COLUMN(modes, bit),
    COLUMN(modes, control),
    COLUMN(modes, status),
    COLUMN(modes, slow_down_ramp),
    COLUMN(pds_states, mask),
    COLUMN(pds_states, value),
    COLUMN(pds_states, state),
    COLUMN(pds_states, power),
    COLUMN(pds_commands, mask),
    COLUMN(pds_commands, value),
    COLUMN(pds_commands, edge),
    COLUMN(pds_commands, command),
    COLUMN(pds_transitions, from),
    COLUMN(pds_transitions, by),
    COLUMN(pds_transitions, to),
    COLUMN(pds_transitions, number),
    COLUMN(homing_methods, method),
    COLUMN(homing_methods, direction),
    COLUMN(homing_methods, edge),
    COLUMN(homing_methods, reference),
    COLUMN(homing_methods, reverse_at),
    COLUMN(homing_methods, flags),
    COLUMN(ramp, parameter),
    COLUMN(ramp, field.at),
    COLUMN(ramp, field.type),
    COLUMN(motor_parameters, index),
    COLUMN(motor_parameters, field.at),
    COLUMN(motor_parameters, field.type),
    LIST(abort_codes),
    { NULL, NULL, 0, 0, 0, 0 },
};
