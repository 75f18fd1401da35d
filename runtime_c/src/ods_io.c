#include "ods_io.h"

#include "ods_axis.h"
#include "ods_emcy.h"
#include "ods_motor.h"

#define FIRST_BIT 16u /* INn and OUTn are bit 16 + n of their objects */
#define ANALOG_MAX 0xFFFFu
#define BLOCKS (sizeof((ods_device_values_t *)0)->input_blocks)

ODS_STATIC_ASSERT(
    every_analog_input_has_a_place,
    sizeof((ods_device_values_t *)0)->analog_inputs / sizeof(uint32_t) == ODS_ANALOG_CHANNELS &&
        sizeof((ods_device_values_t *)0)->analog_input_values / sizeof(int16_t) == ODS_ANALOG_CHANNELS &&
        sizeof((ods_device_values_t *)0)->analog_output_values / sizeof(int16_t) == ODS_ANALOG_CHANNELS);

static uint32_t lines(uint32_t count)
{
    return (count < 32u) ? (1u << count) - 1u : 0xFFFFFFFFu;
}

void ods_io_reset(ods_node_t *node)
{
    node->io.masked_outputs = 0;
    node->io.is_new = 1;
}

void ods_io_set(ods_node_t *node, ods_input_t input, uint8_t channel, uint32_t value)
{
    ods_io_t *const io = &node->io;
    io->is_new = 1;
    if (input == ODS_INPUT_ADDRESS) {
        io->address = (value <= 0xFFu) ? (uint8_t)value : 0u;
    } else if (input == ODS_INPUT_ENABLE) {
        io->enable = (value != 0u);
    } else if (input == ODS_INPUT_DIGITAL) {
        io->digital_inputs = value & lines(node->device->digital_inputs);
    } else if ((input == ODS_INPUT_ANALOG) && (channel < node->device->analog_inputs) &&
               (channel < ODS_ANALOG_CHANNELS)) {
        io->analog_inputs[channel] = (value < ANALOG_MAX) ? value : ANALOG_MAX;
    }
}

/* Put a sample in place, and say whether it is a new one. */
static int sample_8(uint8_t *place, uint32_t value)
{
    const int is_new = *place != (uint8_t)value;
    *place = (uint8_t)value;
    return is_new;
}

static int sample_16(int16_t *place, uint32_t value)
{
    const int is_new = *place != (int16_t)(uint16_t)value;
    *place = (int16_t)(uint16_t)value;
    return is_new;
}

static int sample_32(uint32_t *place, uint32_t value)
{
    const int is_new = *place != value;
    *place = value;
    return is_new;
}

/* Values follow the inputs. */
static void sample(ods_node_t *node)
{
    ods_device_values_t *const values = node->common;
    const ods_io_t *const io = &node->io;
    int is_new = sample_32(&values->general_inputs, io->digital_inputs << FIRST_BIT);

    for (uint32_t n = 0; n < BLOCKS; n++) {
        is_new |= sample_8(&values->input_blocks[n], io->digital_inputs >> (8u * n));
    }
    for (uint32_t n = 0; n < ODS_ANALOG_CHANNELS; n++) {
        is_new |= sample_32(&values->analog_inputs[n], io->analog_inputs[n]);
        is_new |= sample_16(&values->analog_input_values[n], io->analog_inputs[n]);
    }
    if (is_new != 0) {
        ods_value_changed(node, ODS_DEVICE_INSTANCE);
    }
}

void ods_io_tick(ods_node_t *node)
{
    if (node->io.is_new == 0u) {
        return;
    }
    node->io.is_new = 0;
    sample(node);
    for (uint32_t n = 0; n < node->device->axes; n++) {
        ods_axis_wake(&node->axes[n]); /* axes show general inputs as well */
    }
    ods_emcy_set(node, ODS_CONDITION_SHUTDOWN_SWITCH, node->io.enable == 0u);
}

/* Outputs that feed brakes: OUTn that of axis n, while it is controlled automatically (200Ch). */
static uint32_t brakes(const ods_node_t *node)
{
    uint32_t outputs = 0;
    for (uint32_t n = 0; n < node->device->axes; n++) {
        outputs |= (ods_motor_has_brake(&node->axes[n]) ? 1u : 0u) << n;
    }
    return outputs;
}

/*
 * Outputs with a mask (2703h, 3003h): those that it includes follow, the others stay. Outputs in blocks of eight (CiA
 * 401) have none. What a device lacks is 0.
 */
static uint32_t digital_outputs(ods_node_t *node)
{
    const ods_device_values_t *const values = node->common;
    const uint32_t mask = values->output_mask >> FIRST_BIT;
    uint32_t outputs = (node->io.masked_outputs & ~mask) | ((values->digital_outputs >> FIRST_BIT) & mask);

    node->io.masked_outputs = outputs;
    for (uint32_t n = 0; n < BLOCKS; n++) {
        outputs |= (uint32_t)values->output_blocks[n] << (8u * n);
    }
    return outputs & lines(node->device->digital_outputs) & ~brakes(node);
}

static void put(const ods_node_t *node, ods_output_t output, uint32_t channel, uint32_t value)
{
    if (node->port->output != NULL) {
        node->port->output(node->port->context, output, (uint8_t)channel, value);
    }
}

void ods_io_put(ods_node_t *node, int all)
{
    const uint32_t outputs = digital_outputs(node);
    if (all || (outputs != node->io.digital_outputs)) {
        node->io.digital_outputs = outputs;
        put(node, ODS_OUTPUT_DIGITAL, 0, outputs);
    }
    for (uint32_t n = 0; (n < ODS_ANALOG_CHANNELS) && (n < node->device->analog_outputs); n++) {
        const int16_t value = node->common->analog_output_values[n];
        if (all || (value != node->io.analog_outputs[n])) {
            node->io.analog_outputs[n] = value;
            put(node, ODS_OUTPUT_ANALOG, n, (uint16_t)value);
        }
    }
}
