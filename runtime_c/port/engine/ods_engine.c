#include "ods_engine.h"

#include <stddef.h>
#include <string.h>

#include "ods/node.h"
#include "ods_simulation.h"
#include "tmcm6212.h"

#define QUEUE 512u
#define LONGEST_STEP (1u << 29) /* us; see ods_node_advance() */

struct engine {
    engine_front_t front;
    tmcm6212_t drive;
    ods_port_t port;
    ods_config_t config;
    uint8_t *memory;
    uint32_t head; /* of the queue: the frame that was put in last stands before it */
    engine_frame_t queue[QUEUE];
    ods_simulation_t hardware[ENGINE_AXES];
};

/* ---- the port ---------------------------------------------------------------------------------------------------- */

static void send_frame(void *context, const ods_frame_t *frame)
{
    engine_t *const engine = context;
    engine_front_t *const front = &engine->front;

    if (front->queued == QUEUE) {
        front->dropped++;
        return;
    }
    const uint32_t late = (uint32_t)front->now - engine->drive.node.now;
    engine->queue[engine->head] = (engine_frame_t){ .time = front->now - late, .frame = *frame };
    engine->head = (engine->head + 1u) % QUEUE;
    front->queued++;
}

static void set_output(void *context, ods_output_t output, uint8_t channel, uint32_t value)
{
    engine_t *const engine = context;
    engine_front_t *const front = &engine->front;

    switch (output) {
    case ODS_OUTPUT_RUN_LED:
        front->run_led = value;
        break;
    case ODS_OUTPUT_ERROR_LED:
        front->error_led = value;
        break;
    case ODS_OUTPUT_DIGITAL:
        front->digital = value;
        break;
    case ODS_OUTPUT_ANALOG:
        front->analog[channel % ENGINE_ANALOG] = value;
        break;
    case ODS_OUTPUT_POWER:
        front->power[channel] = value;
        break;
    case ODS_OUTPUT_BRAKE:
        front->brake[channel] = value;
        break;
    case ODS_OUTPUT_CURRENT:
        front->current[channel] = value;
        break;
    case ODS_OUTPUT_DRIVER:
        front->driver[channel] = value;
        break;
    case ODS_OUTPUTS:
        break;
    }
    if ((output >= ODS_OUTPUT_POWER) && (output < ODS_OUTPUTS)) {
        ods_simulation_output(&engine->hardware[channel], output, value);
    }
}

static void join_bus(void *context, uint16_t bit_rate, uint8_t node_id)
{
    engine_t *const engine = context;

    engine->front.bit_rate = bit_rate;
    engine->front.node_id = node_id;
}

static int read_memory(void *context, uint32_t address, uint8_t *octet)
{
    const engine_t *const engine = context;

    *octet = engine->memory[address];
    return 0;
}

static int write_memory(void *context, uint32_t address, uint8_t octet)
{
    engine_t *const engine = context;

    engine->memory[address] = octet;
    engine->front.memory_writes++;
    return 0;
}

static void drive_motor(void *context, uint8_t axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer)
{
    engine_t *const engine = context;

    ods_simulation_motor(&engine->hardware[axis], demand, answer);
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

uint32_t engine_abi(void)
{
    return ENGINE_ABI;
}

uint32_t engine_size(void)
{
    return (uint32_t)sizeof(engine_t);
}

uint32_t engine_axes(void)
{
    return tmcm6212_device.axes;
}

uint32_t engine_memory_size(void)
{
    return ods_store_size(&tmcm6212_device);
}

void engine_init(engine_t *engine, uint8_t *memory, uint32_t node_id, uint32_t serial_number)
{
    memset(engine, 0, sizeof(*engine));
    engine->memory = memory;
    engine->config = (ods_config_t){ .serial_number = serial_number, .node_id = (uint8_t)node_id };
    engine->port = (ods_port_t){
        .context = engine,
        .send = send_frame,
        .output = set_output,
        .bus = join_bus,
        .nvm_read = read_memory,
        .nvm_write = write_memory,
        .motor = drive_motor,
    };
    for (uint32_t axis = 0; axis < engine_axes(); axis++) {
        ods_simulation_init(&engine->hardware[axis]);
    }
    engine_reset(engine);
}

void engine_reset(engine_t *engine)
{
    engine_front_t *const front = &engine->front;

    *front = (engine_front_t){
        .now = front->now,
        .next = ENGINE_NEVER,
        .dropped = front->dropped,
        .memory_writes = front->memory_writes,
        .queued = front->queued,
    };
    tmcm6212_init(&engine->drive, &engine->port, &engine->config);
    for (uint32_t axis = 0; axis < engine_axes(); axis++) {
        ods_simulation_power_on(&engine->hardware[axis]);
        ods_node_motor(&engine->drive.node, 0, (uint8_t)axis, &engine->hardware[axis].answer);
    }
}

/* What is to be seen follows an event. */
static void show(engine_t *engine)
{
    engine_front_t *const front = &engine->front;
    const ods_node_t *const node = &engine->drive.node;
    uint32_t at;

    front->nmt_state = node->state;
    front->next = ods_node_next(node, &at) ? (front->now + (at - (uint32_t)front->now)) : ENGINE_NEVER;
}

void engine_power_on(engine_t *engine, uint64_t now)
{
    engine->front.now = now;
    engine->drive.node.now = (uint32_t)now; /* for what it sends on the way */
    ods_node_power_on(&engine->drive.node, (uint32_t)now);
    show(engine);
}

/* ---- events ------------------------------------------------------------------------------------------------------ */

int engine_advance(engine_t *engine, uint64_t until)
{
    engine_front_t *const front = &engine->front;

    do {
        if (front->queued > (QUEUE / 2u)) {
            return 0;
        }
        uint64_t to = (until > front->now) ? until : front->now;
        if ((to - front->now) > LONGEST_STEP) {
            to = front->now + LONGEST_STEP;
        }
        if ((front->next > front->now) && (front->next < to)) {
            to = front->next;
        }
        front->now = to;
        ods_node_advance(&engine->drive.node, (uint32_t)to);
        show(engine);
    } while (front->now < until);
    return 1;
}

void engine_receive(engine_t *engine, uint32_t id, uint32_t length, uint32_t remote, const uint8_t *data)
{
    ods_frame_t frame = { .id = (uint16_t)id, .length = (uint8_t)length, .remote = (uint8_t)remote };

    if (remote == 0u) {
        memcpy(frame.data, data, (length < sizeof(frame.data)) ? length : sizeof(frame.data));
    }
    ods_node_receive(&engine->drive.node, (uint32_t)engine->front.now, &frame);
    show(engine);
}

void engine_input(engine_t *engine, uint32_t input, uint32_t channel, uint32_t value)
{
    ods_node_input(
        &engine->drive.node, (uint32_t)engine->front.now, (ods_input_t)input, (uint8_t)channel, value);
    show(engine);
}

void engine_fault(engine_t *engine, uint32_t axis, uint32_t condition, uint32_t holds)
{
    ods_node_fault(
        &engine->drive.node,
        (uint32_t)engine->front.now,
        (uint8_t)axis,
        (ods_condition_t)condition,
        (int)holds);
    show(engine);
}

void engine_can(engine_t *engine, uint32_t event)
{
    ods_node_can(&engine->drive.node, (uint32_t)engine->front.now, (ods_can_t)event);
    show(engine);
}

int engine_hardware(engine_t *engine, uint32_t axis, const char *name, int32_t value, uint32_t is_on)
{
    ods_simulation_t *const hardware = &engine->hardware[axis];
    const ods_simulation_input_t input = ods_simulation_find(name);

    if (input == ODS_SIMULATION_INPUTS) {
        return 1;
    }
    if (!ods_simulation_set(hardware, input, value)) {
        return 2;
    }
    if (is_on != 0u) {
        ods_node_motor(&engine->drive.node, (uint32_t)engine->front.now, (uint8_t)axis, &hardware->answer);
        show(engine);
    }
    return 0;
}

/* ---- many at once ------------------------------------------------------------------------------------------------ */

uint64_t engines_next(engine_t *const *engines, uint32_t count)
{
    uint64_t next = ENGINE_NEVER;

    for (uint32_t i = 0; i < count; i++) {
        if (engines[i]->front.next < next) {
            next = engines[i]->front.next;
        }
    }
    return next;
}

uint64_t engines_run(engine_t *const *engines, uint32_t count, uint64_t until)
{
    uint64_t at = engines_next(engines, count);

    while (at <= until) {
        uint32_t queued = 0;

        for (uint32_t i = 0; i < count; i++) {
            if (engines[i]->front.next <= at) {
                (void)engine_advance(engines[i], at);
            }
            queued |= engines[i]->front.queued;
        }
        if (queued != 0u) {
            return at;
        }
        at = engines_next(engines, count);
    }
    return until;
}

uint32_t engines_deliver(
    engine_t *const *engines, uint32_t count, uint32_t except, uint64_t now, uint32_t id, uint32_t length,
    uint32_t remote, const uint8_t *data)
{
    uint32_t answering = 0;

    for (uint32_t i = 0; i < count; i++) {
        if (i != except) {
            if (engines[i]->front.now < now) {
                (void)engine_advance(engines[i], now);
            }
            engine_receive(engines[i], id, length, remote, data);
        }
        answering += (engines[i]->front.queued != 0u) ? 1u : 0u;
    }
    return answering;
}

/* ---- what is to be seen ------------------------------------------------------------------------------------------ */

int64_t engine_shaft(const engine_t *engine, uint32_t axis)
{
    return engine->hardware[axis].shaft;
}

uint32_t engine_take(engine_t *engine, engine_frame_t *frames, uint32_t room)
{
    engine_front_t *const front = &engine->front;
    const uint32_t count = (front->queued < room) ? front->queued : room;

    for (uint32_t i = 0; i < count; i++) {
        frames[i] = engine->queue[(engine->head + QUEUE - front->queued) % QUEUE];
        front->queued--;
    }
    return count;
}

uint32_t engine_read(
    const engine_t *engine, uint32_t index, uint32_t sub, uint8_t *octets, uint32_t size, uint16_t *length)
{
    return ods_node_read(
        &engine->drive.node, (uint16_t)index, (uint8_t)sub, octets, (uint16_t)size, length);
}
