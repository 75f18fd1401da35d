/*
 * A device with simulated motors and memory as a shared library, for programs in other languages.
 *
 * Nothing here calls back: frames that the device sends wait in a queue until they are taken, outputs stand in a struct
 * that can be read at any time. So a program crosses the border once for each event, and one process can hold many.
 *
 *     engine_t *engine = calloc(1, engine_size());      all memory of a device
 *     engine_init(engine, memory, node_id, serial);     `memory` has engine_memory_size() octets
 *     engine_reset(engine);                             before each power-on; then inputs, then
 *     engine_power_on(engine, now);
 *     while (!engine_advance(engine, until)) { engine_take(engine, frames, room); }
 *
 * Time is in microseconds, 64 bits that do not wrap. `engine_advance` stops early when half of the queue is full, and
 * returns 0 then; every other function wants it to have reached the present.
 */
#ifndef ODS_ENGINE_H
#define ODS_ENGINE_H

#include <stdint.h>

#include "ods/port.h"
#include "ods/vocabulary.h"

#define ENGINE_ABI 2u /* of everything in this header */
#define ENGINE_AXES 256u /* as many as a channel can name */
#define ENGINE_ANALOG 8u
#define ENGINE_NEVER UINT64_MAX

/* A frame and when it left. */
typedef struct {
    uint64_t time;
    ods_frame_t frame;
} engine_frame_t;

/* What is to be seen of the device; the first member of an engine. */
typedef struct {
    uint64_t now;
    uint64_t next; /* the next instant at which it has something to do, or ENGINE_NEVER */
    uint32_t queued; /* frames that wait to be taken */
    uint32_t dropped; /* frames that found no room, ever */
    uint32_t memory_writes;
    uint32_t bit_rate; /* kbit/s */
    uint32_t node_id;
    uint32_t nmt_state; /* as the heartbeat carries it */
    uint32_t run_led;
    uint32_t error_led;
    uint32_t digital;
    uint32_t analog[ENGINE_ANALOG];
    uint32_t power[ENGINE_AXES];
    uint32_t brake[ENGINE_AXES];
    uint32_t current[ENGINE_AXES];
    uint32_t driver[ENGINE_AXES];
} engine_front_t;

typedef struct engine engine_t;

uint32_t engine_abi(void);
uint32_t engine_size(void);
uint32_t engine_memory_size(void);
uint32_t engine_axes(void);

void engine_init(engine_t *engine, uint8_t *memory, uint32_t node_id, uint32_t serial_number);
void engine_reset(engine_t *engine);
void engine_power_on(engine_t *engine, uint64_t now);

int engine_advance(engine_t *engine, uint64_t until);
void engine_receive(engine_t *engine, uint32_t id, uint32_t length, uint32_t remote, const uint8_t *data);
void engine_input(engine_t *engine, uint32_t input, uint32_t channel, uint32_t value);
void engine_fault(engine_t *engine, uint32_t axis, uint32_t condition, uint32_t holds);
void engine_can(engine_t *engine, uint32_t event);

/* An input of the simulated hardware by its name. Returns 0, 1 for an unknown name, 2 for a value out of its range. */
int engine_hardware(engine_t *engine, uint32_t axis, const char *name, int32_t value, uint32_t is_on);
int64_t engine_shaft(const engine_t *engine, uint32_t axis);

/* Take at most `room` frames, the oldest first; returns how many. */
uint32_t engine_take(engine_t *engine, engine_frame_t *frames, uint32_t room);

/*
 * Many at once, which share a bus: their time passes in step. engines_run() stops at the first instant at which one of
 * them has sent something, and returns the instant that it has reached; engines_deliver() brings a frame to all but the
 * one at `except`, and returns how many of them have something to take. None of them may be without power.
 */
uint64_t engines_next(engine_t *const *engines, uint32_t count);
uint64_t engines_run(engine_t *const *engines, uint32_t count, uint64_t until);
uint32_t engines_deliver(
    engine_t *const *engines, uint32_t count, uint32_t except, uint64_t now, uint32_t id, uint32_t length,
    uint32_t remote, const uint8_t *data);

/* As ods_node_read(). */
uint32_t engine_read(
    const engine_t *engine, uint32_t index, uint32_t sub, uint8_t *octets, uint32_t size, uint16_t *length);

#endif
