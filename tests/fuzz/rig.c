#include "rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GARBAGE 0xA5 /* what memory holds when power comes up */

void rig_broken(const char *promise, const char *file, int line)
{
    fprintf(stderr, "%s:%d: broken promise: %s\n", file, line, promise);
    abort();
}

static void *block(size_t size)
{
    void *const memory = malloc((size == 0u) ? 1u : size);
    if (memory == NULL) {
        exit(2);
    }
    return memory;
}

/* ---- the port ---------------------------------------------------------------------------------------------------- */

/* What a node may send depends on its NMT state (CiA 301, 7.3.2.2.4). */
static void check_frame(const rig_t *rig, const ods_frame_t *frame)
{
    const ods_node_t *const node = rig->node;
    const uint32_t sdo = 0x580u + node->id;
    const uint32_t error_control = 0x700u + node->id;
    const uint32_t emcy = node->common->cob_id_emcy & 0x7FFu;

    PROMISE(frame->length <= 8u);
    PROMISE(frame->id <= 0x7FFu);
    PROMISE(frame->remote == 0u);
    PROMISE(node->can != (uint8_t)ODS_CAN_BUS_OFF);
    if (frame->id == error_control) {
        PROMISE(frame->length == 1u);
        return;
    }
    PROMISE(node->state != (uint8_t)ODS_NMT_STATE_STOPPED);
    PROMISE(node->state != (uint8_t)ODS_NMT_STATE_INITIALISING);
    if (frame->id == sdo) {
        PROMISE(frame->length == 8u);
        return;
    }
    if (node->state == (uint8_t)ODS_NMT_STATE_PRE_OPERATIONAL) {
        PROMISE((frame->id == emcy) && (frame->length == 8u));
    }
}

static void on_send(void *context, const ods_frame_t *frame)
{
    rig_t *const rig = context;
    PROMISE(rig->sending);
    if (rig->dead) {
        return;
    }
    check_frame(rig, frame);
    rig->frames++;
    if (frame->id == 0x580u + rig->node->id) {
        rig->answers++;
        rig->answer = *frame;
    }
}

/* How many channels an output has. */
static uint32_t channels_of(const rig_t *rig, ods_output_t output)
{
    if (output == ODS_OUTPUT_ANALOG) {
        return RIG_CHANNELS;
    }
    return (output >= ODS_OUTPUT_POWER) ? rig->device->axes : 1u;
}

static void on_output(void *context, ods_output_t output, uint8_t channel, uint32_t value)
{
    static const uint32_t highest[ODS_OUTPUTS] = {
        [ODS_OUTPUT_RUN_LED] = 1,
        [ODS_OUTPUT_ERROR_LED] = 1,
        [ODS_OUTPUT_DIGITAL] = UINT32_MAX,
        [ODS_OUTPUT_ANALOG] = UINT16_MAX,
        [ODS_OUTPUT_POWER] = 1,
        [ODS_OUTPUT_BRAKE] = UINT8_MAX,
        [ODS_OUTPUT_CURRENT] = 32,
        [ODS_OUTPUT_DRIVER] =
            ODS_DRIVER_COOL_STEP | ODS_DRIVER_STEALTH_CHOP | ODS_DRIVER_DC_STEP | ODS_DRIVER_HIGH_SPEED,
    };
    rig_t *const rig = context;
    PROMISE(rig->sending);
    PROMISE((uint32_t)output < (uint32_t)ODS_OUTPUTS);
    PROMISE(channel < channels_of(rig, output));
    PROMISE(value <= highest[output]);
    PROMISE((rig->waking && (output < ODS_OUTPUT_POWER)) || (value != rig->outputs[output][channel]));
    rig->outputs[output][channel] = value;
    rig->changes++;
}

static void on_motor_set(void *context, uint8_t axis, uint16_t parameter, int32_t value)
{
    const rig_t *const rig = context;
    ods_od_ref_t ref;
    (void)value;
    PROMISE(axis < rig->device->axes);
    PROMISE(ods_od_find(rig->device->od, parameter, 0, &ref) == 0u);
}

/* Only an axis with power makes steps. The encoder counts them. */
static void on_motor(void *context, uint8_t axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer)
{
    rig_t *const rig = context;
    PROMISE(axis < rig->device->axes);
    PROMISE((demand->steps == 0) || rig_has_power(rig, axis));
    PROMISE((demand->velocity == 0) || rig_has_power(rig, axis));
    rig->motors[axis].encoder = (int32_t)((uint32_t)rig->motors[axis].encoder + (uint32_t)demand->steps);
    rig->motors[axis].velocity = demand->velocity;
    *answer = rig->motors[axis];
}

static void on_bus(void *context, uint16_t bit_rate, uint8_t node_id)
{
    const rig_t *const rig = context;
    const ods_device_t *const device = rig->device;
    uint32_t known = 0;
    for (uint32_t n = 0; n < device->bit_rate_count; n++) {
        known += (device->bit_rates[n] == bit_rate) ? 1u : 0u;
    }
    PROMISE(known == 1u);
    PROMISE((node_id >= 1u) && (node_id <= 127u));
}

static int on_nvm_read(void *context, uint32_t address, uint8_t *octet)
{
    const rig_t *const rig = context;
    PROMISE(address < rig->nvm_size);
    *octet = rig->nvm[address];
    return rig->nvm_fails;
}

static int on_nvm_write(void *context, uint32_t address, uint8_t octet)
{
    rig_t *const rig = context;
    PROMISE(address < rig->nvm_size);
    if (rig->nvm_fails) {
        return 1;
    }
    if (rig->writes_left == 0u) {
        rig->dead = 1;
    }
    if (!rig->dead) {
        rig->nvm[address] = octet;
    }
    if (rig->writes_left != RIG_NO_CUT && rig->writes_left > 0u) {
        rig->writes_left--;
    }
    return 0;
}

static ods_os_status_t on_os_command(
    void *context, const uint8_t command[ODS_OS_COMMAND_SIZE], uint8_t reply[ODS_OS_COMMAND_SIZE])
{
    const rig_t *const rig = context;
    for (uint32_t n = 0; n < ODS_OS_COMMAND_SIZE; n++) {
        PROMISE(reply[n] == 0u);
        reply[n] = (uint8_t)(command[n] ^ 0xFFu);
    }
    return (ods_os_status_t)(rig->os_status & 3u);
}

int rig_has_power(const rig_t *rig, uint8_t axis)
{
    for (uint32_t n = 0; n < rig->device->pds_state_count; n++) {
        if (rig->device->pds_states[n].state == rig->node->axes[axis].state) {
            return rig->device->pds_states[n].power;
        }
    }
    return 0;
}

/* ---- the bench --------------------------------------------------------------------------------------------------- */

static uint32_t find_entries(const ods_od_t *od, rig_entry_t *entries)
{
    uint32_t count = 0;
    for (uint32_t address = 0; address <= 0xFFFFFFu; address++) {
        rig_entry_t entry = { (uint16_t)(address >> 8), (uint8_t)address, { NULL, 0 } };
        const uint32_t code = ods_od_find(od, entry.index, entry.sub, &entry.ref);
        if (code == (uint32_t)ODS_ABORT_NO_OBJECT) {
            address |= 0xFFu;
        }
        if (code == 0u) {
            if (entries != NULL) {
                entries[count] = entry;
            }
            count++;
        }
    }
    return count;
}

void rig_make(rig_t *rig, const ods_device_t *device)
{
    const ods_od_t *const od = device->od;
    const size_t rpdos = (size_t)od->scope_instances[ODS_SCOPE_RPDO + 1] - od->scope_instances[ODS_SCOPE_RPDO];
    const size_t tpdos = (size_t)od->scope_instances[ODS_SCOPE_TPDO + 1] - od->scope_instances[ODS_SCOPE_TPDO];
    rig_entry_t *entries;

    memset(rig, 0, sizeof *rig);
    rig->device = device;
    rig->entry_count = find_entries(od, NULL);
    entries = block(rig->entry_count * sizeof *entries);
    find_entries(od, entries);
    rig->entries = entries;

    rig->node = block(sizeof *rig->node);
    rig->memory.values = block(od->values_size);
    rig->memory.axes = block(device->axes * sizeof(ods_axis_t));
    rig->memory.rpdos = block(rpdos * sizeof(ods_rpdo_t));
    rig->memory.tpdos = block(tpdos * sizeof(ods_tpdo_t));
    rig->memory.mapped = block((rpdos + tpdos) * od->max_mapped * sizeof(ods_pdo_ref_t));
    rig->memory.buffer = block(od->buffer_size);
    rig->nvm_size = ods_store_size(device);
    rig->nvm = block(rig->nvm_size);
}

void rig_renew(rig_t *rig, uint8_t lacks)
{
    rig->port.context = rig;
    rig->port.send = on_send;
    rig->port.output = (lacks & 1u) ? NULL : on_output;
    rig->port.bus = (lacks & 2u) ? NULL : on_bus;
    rig->port.nvm_read = (lacks & 4u) ? NULL : on_nvm_read;
    rig->port.nvm_write = (lacks & 8u) ? NULL : on_nvm_write;
    rig->port.os_command = (lacks & 16u) ? NULL : on_os_command;
    rig->port.motor_set = (lacks & 32u) ? NULL : on_motor_set;
    rig->port.motor = (lacks & 64u) ? NULL : on_motor;
    memset(rig->motors, 0, sizeof rig->motors);
    memset(rig->nvm, 0xFF, rig->nvm_size);
    rig->nvm_fails = 0;
    rig->writes_left = RIG_NO_CUT;
    rig->os_status = 0;
    rig->config.serial_number = 0x12345678u;
    rig->config.node_id = 0;
}

void rig_power_on(rig_t *rig, uint32_t now, uint8_t address)
{
    const ods_device_t *const device = rig->device;
    const ods_od_t *const od = device->od;
    const uint16_t *const instances = od->scope_instances;
    const size_t rpdos = (size_t)instances[ODS_SCOPE_RPDO + 1] - instances[ODS_SCOPE_RPDO];
    const size_t tpdos = (size_t)instances[ODS_SCOPE_TPDO + 1] - instances[ODS_SCOPE_TPDO];

    memset(rig->node, GARBAGE, sizeof *rig->node);
    memset(rig->memory.values, GARBAGE, od->values_size);
    memset(rig->memory.axes, GARBAGE, device->axes * sizeof(ods_axis_t));
    memset(rig->memory.rpdos, GARBAGE, rpdos * sizeof(ods_rpdo_t));
    memset(rig->memory.tpdos, GARBAGE, tpdos * sizeof(ods_tpdo_t));
    memset(rig->memory.mapped, GARBAGE, (rpdos + tpdos) * od->max_mapped * sizeof(ods_pdo_ref_t));
    memset(rig->memory.buffer, GARBAGE, od->buffer_size);
    memset(rig->outputs, 0, sizeof rig->outputs);
    rig->dead = 0;
    rig->writes_left = RIG_NO_CUT;

    ods_node_init(rig->node, device, &rig->memory, &rig->port, &rig->config);
    rig_turn(rig);
    rig->waking = 1;
    if (address != 0u) {
        ods_node_input(rig->node, now, ODS_INPUT_ADDRESS, 0, address);
    }
    for (uint8_t axis = 0; axis < device->axes; axis++) {
        ods_node_motor(rig->node, now, axis, &rig->motors[axis]);
    }
    ods_node_power_on(rig->node, now);
    rig->waking = 0;
}

void rig_motor(rig_t *rig, uint32_t now, uint8_t axis, const ods_motor_answer_t *answer)
{
    rig->motors[axis] = *answer;
    ods_node_motor(rig->node, now, axis, answer);
}

void rig_turn(rig_t *rig)
{
    rig->sending = 1;
    rig->frames = 0;
    rig->answers = 0;
    rig->changes = 0;
}
