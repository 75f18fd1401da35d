/*
 * A node on a bench: its memory in blocks of exactly the size that the tables state, so that a sanitizer sees every
 * step beside them, and a port that watches what the node does.
 */
#ifndef ODS_FUZZ_RIG_H
#define ODS_FUZZ_RIG_H

#include <stdint.h>

#include "ods/node.h"

/* An entry of the dictionary, found by asking for every address. */
typedef struct {
    uint16_t index;
    uint8_t sub;
    ods_od_ref_t ref;
} rig_entry_t;

#define RIG_CHANNELS 8u /* of an output: analog ones, axes */

typedef struct {
    const ods_device_t *device;
    const rig_entry_t *entries; /* all there are */
    uint32_t entry_count;

    ods_node_t *node;
    ods_memory_t memory;
    ods_port_t port;
    ods_config_t config;

    uint8_t *nvm;
    uint32_t nvm_size;
    uint32_t writes_left; /* power is lost at the write after so many; RIG_NO_CUT: it stays */
    uint8_t nvm_fails;
    uint8_t dead; /* power was lost within a turn */
    uint8_t os_status;
    uint8_t waking; /* inside of ods_node_power_on(): every output is told */
    uint8_t sending; /* frames may be sent: a turn is going on */

    uint32_t frames; /* sent in this turn */
    uint32_t answers; /* of the SDO server in this turn */
    uint32_t changes; /* outputs told in this turn */
    ods_frame_t answer; /* the last one */
    uint32_t outputs[ODS_OUTPUTS][RIG_CHANNELS]; /* as told last */
    ods_motor_answer_t motors[RIG_CHANNELS]; /* what the hardware of each axis has to say */
} rig_t;

#define RIG_NO_CUT 0xFFFFFFFFu

/* Stop with a message unless the condition holds: the node has broken a promise. */
#define PROMISE(condition) ((condition) ? (void)0 : rig_broken(#condition, __FILE__, __LINE__))

void rig_broken(const char *promise, const char *file, int line);

/* Make a bench for a device. Everything is allocated once and lives as long as the process. */
void rig_make(rig_t *rig, const ods_device_t *device);

/* A new device out of its box: memory that was never written. Bits of `lacks` take callbacks of the port away. */
void rig_renew(rig_t *rig, uint8_t lacks);

/* Power comes back: nothing but the non-volatile memory has kept its content. */
void rig_power_on(rig_t *rig, uint32_t now, uint8_t address);

/* Whether the state in which an axis is has power. */
int rig_has_power(const rig_t *rig, uint8_t axis);

/* The hardware of an axis has something new to say. */
void rig_motor(rig_t *rig, uint32_t now, uint8_t axis, const ods_motor_answer_t *answer);

/* A turn begins: nothing was sent yet. */
void rig_turn(rig_t *rig);

#endif
