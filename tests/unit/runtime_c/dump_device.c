/*
 * Prints the tables of a device beside its objects, a line for each row: the name of the table, then its members.
 * Where a row leads to a value of an axis, the index of the object that has it is printed.
 * Compile with -DDEVICE_HEADER='"x_device.h"' -DDEVICE=x_device -DABORT_CODES=x_abort_codes and
 * -DABORT_COUNT=X_ABORT_CODES.
 */
#include DEVICE_HEADER

#include <inttypes.h>
#include <stdio.h>

/* The index of the object of axis 0 whose value lies at an offset; 0 if there is none. */
static uint32_t index_of(const ods_device_t *device, uint32_t at)
{
    for (uint32_t index = 0; index <= 0xFFFFu; index++) {
        ods_od_ref_t ref = { NULL, 0 };
        if ((ods_od_find(device->od, (uint16_t)index, 0, &ref) == 0u) && (ref.entry->at == at) &&
            (ref.instance == device->od->scope_instances[ODS_SCOPE_AXIS]) && ((ref.entry->kind & ODS_CONST) == 0u)) {
            return index;
        }
    }
    return 0;
}

static void print_drive(const ods_device_t *device)
{
    for (uint32_t n = 0; n < device->mode_count; n++) {
        const ods_mode_row_t *const row = &device->modes[n];
        printf("mode %d %u %u %u", row->code, row->bit, row->control, row->status);
        if (row->slow_down_ramp != ODS_NOWHERE) {
            printf(" %" PRIu32, index_of(device, row->slow_down_ramp));
        }
        printf("\n");
    }
    for (uint32_t n = 0; n < device->pds_state_count; n++) {
        const ods_pds_state_row_t *const row = &device->pds_states[n];
        printf("state %u %u %u %u\n", row->state, row->mask, row->value, row->power);
    }
    for (uint32_t n = 0; n < device->pds_command_count; n++) {
        const ods_pds_command_row_t *const row = &device->pds_commands[n];
        printf("command %u %u %u %u\n", row->command, row->mask, row->value, row->edge);
    }
    for (uint32_t n = 0; n < device->pds_transition_count; n++) {
        const ods_pds_transition_row_t *const row = &device->pds_transitions[n];
        printf("transition %u %u %u %u\n", row->number, row->from, row->by, row->to);
    }
    for (uint32_t n = 0; n < device->homing_count; n++) {
        const ods_homing_row_t *const row = &device->homing_methods[n];
        printf("homing %d %d %d", row->method, row->direction, row->edge);
        printf(" %u %u %u\n", row->reference, row->reverse_at, row->flags);
    }
    for (uint32_t n = 0; n < device->ramp_count; n++) {
        const ods_ramp_row_t *const row = &device->ramp[n];
        printf("ramp %u %" PRIu32 " %u\n", row->parameter, index_of(device, row->field.at), row->field.type);
    }
    for (uint32_t n = 0; n < device->motor_parameter_count; n++) {
        const ods_motor_parameter_row_t *const row = &device->motor_parameters[n];
        printf("motor_parameter %u %" PRIu32 " %u\n", row->index, index_of(device, row->field.at), row->field.type);
    }
}

static void print_device(const ods_device_t *device)
{
    printf("identity %s %" PRIu32 " %" PRIu32, device->name, device->vendor_id, device->product_code);
    printf(" %" PRIu32 " %u", device->revision_number, device->axes);
    printf(" %u %u", device->digital_inputs, device->digital_outputs);
    printf(" %u %u\n", device->analog_inputs, device->analog_outputs);
    for (uint32_t n = 0; n < device->bit_rate_count; n++) {
        printf("bit_rate %u\n", device->bit_rates[n]);
    }
    for (uint32_t n = 0; n < device->nmt_state_count; n++) {
        printf("nmt_state %u %u\n", device->nmt_states[n].state, device->nmt_states[n].services);
    }
    for (uint32_t n = 0; n < device->nmt_command_count; n++) {
        printf("nmt_command %u %u\n", device->nmt_commands[n].command, device->nmt_commands[n].state);
    }
    for (uint32_t n = 0; n < device->error_behaviour_count; n++) {
        const ods_error_behaviour_row_t *const row = &device->error_behaviours[n];
        printf("error_behaviour %u %u\n", row->value, row->state);
    }
    for (uint32_t n = 0; n < device->led_count; n++) {
        const ods_led_row_t *const row = &device->leds[n];
        printf("led %u %u %u %u", row->led, row->when, row->priority, row->steady);
        for (uint32_t phase = 0; phase < row->phases; phase++) {
            printf(" %u", device->led_phases[row->first + phase]);
        }
        printf("\n");
    }
    for (uint32_t n = 0; n < device->emergency_count; n++) {
        const ods_emergency_row_t *const row = &device->emergencies[n];
        printf("emergency %u", row->code);
        for (uint32_t octet = 0; octet < 5u; octet++) {
            printf(" %u", row->bytes[octet]);
        }
        printf(" %u %u %u", row->axis_byte, row->error_register, row->condition);
        printf(" %u %u %u\n", row->reaction, row->momentary, row->driver_flag);
    }
    for (uint32_t n = 0; n < device->store_count; n++) {
        const ods_store_row_t *const row = &device->stores[n];
        printf("store %u %u %u %u\n", row->index, row->sub, row->groups, row->axis);
    }
}

static void print_dictionary(const ods_od_t *od)
{
    printf("layout %" PRIu32 "\n", od->layout);
    for (uint32_t n = 0; n < od->area_count; n++) {
        printf("area %u %u %u\n", od->areas[n].first, od->areas[n].last, od->areas[n].stride);
    }
}

static void print_abort_codes(void)
{
#if ABORT_COUNT > 0u
    for (uint32_t n = 0; n < ABORT_COUNT; n++) {
        printf("abort %" PRIu32 "\n", ABORT_CODES[n]);
    }
#endif
}

int main(void)
{
    print_device(&DEVICE);
    print_drive(&DEVICE);
    print_dictionary(DEVICE.od);
    print_abort_codes();
    return 0;
}
