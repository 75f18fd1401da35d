/*
 * A queue of frames between an interrupt handler and the main loop: one side puts, the other takes, no lock.
 *
 * Each index is written by one side only, and all of it is volatile: a compiler has to keep the order of accesses.
 * This is enough where both sides run on one core, as on any Cortex-M with a single one.
 */
#ifndef FRAME_QUEUE_H
#define FRAME_QUEUE_H

#include <stdint.h>

#include "ods/port.h"

#define FRAME_QUEUE_SIZE 64u /* a power of two, 128 at most */

/* A queue of zeros is empty. */
typedef struct {
    volatile ods_frame_t frames[FRAME_QUEUE_SIZE];
    volatile uint8_t put; /* counts the frames that were put */
    volatile uint8_t taken;
    volatile uint8_t lost; /* counts those that found no room */
} frame_queue_t;

void frame_queue_put(frame_queue_t *queue, const ods_frame_t *frame);

/* Returns 0 if the queue is empty. */
int frame_queue_take(frame_queue_t *queue, ods_frame_t *frame);

#endif
