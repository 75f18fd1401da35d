/*
 * A CANopen node: one device on the bus.
 *
 *     static NAME_t drive;                                all memory of the node, from the generated header NAME.h
 *     NAME_init(&drive, &port, &config);
 *     ods_node_power_on(&drive.node, now_us());
 *     for (;;) {
 *         while (can_receive(&frame)) {
 *             ods_node_receive(&drive.node, now_us(), &frame);
 *         }
 *         ods_node_advance(&drive.node, now_us());
 *     }
 *
 * Every function that takes the time is one turn: the node first works off what became due in the meantime, at the
 * instants at which it became due, then the event, then everything that follows from it. Time stands still in a turn.
 * At one instant things happen in this order:
 *
 *     SDO time-out; consumer heartbeat and life guarding; the tick; the producers' timers
 *     frames: SDO, guarding or boot-up answer; EMCY; heartbeat; TPDOs ascending
 *     outputs
 *
 * Ticks fall at power-on + k * 1 ms. A tick in which nothing can happen is not waited for.
 *
 * Time may not run back, and ods_node_advance() has to be called at least every 2^30 us (17 minutes). No function
 * blocks, allocates, recurses or keeps anything outside the memory of the node.
 */
#ifndef ODS_NODE_H
#define ODS_NODE_H

#include <stdint.h>

#include "ods/device.h"
#include "ods/od.h"
#include "ods/port.h"
#include "ods/values.h"
#include "ods/vocabulary.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a single device is told at the factory. */
typedef struct {
    uint32_t serial_number; /* 1018h:04 */
    uint8_t node_id; /* default of the stored node-ID; 0: as the specification says */
} ods_config_t;

/* ---- the state of a node: for the runtime alone -------------------------------------------------------------------
 * The structs stand here only so that the caller can provide their memory. One for each module of the runtime.
 */

/* Timers that there are once in a node; those of TPDOs are theirs. */
typedef enum {
    ODS_TIMER_SDO, /* the client is silent */
    ODS_TIMER_CONSUMER_1, /* a watched heartbeat is late; one for each sub-index of 1016h */
    ODS_TIMER_CONSUMER_LAST = ODS_TIMER_CONSUMER_1 + 3,
    ODS_TIMER_LIFE, /* life time is over, or a part of it that is as long as a timer may be */
    ODS_TIMER_TICK, /* the next tick; its instant holds even while it is not armed */
    ODS_TIMER_HEARTBEAT, /* the next heartbeat is due */
    ODS_TIMER_EMCY, /* the inhibit time of emergencies ends */
    ODS_TIMER_RUN_LED, /* the next phase of a pattern; in the order of ods_led_t */
    ODS_TIMER_ERROR_LED,
    ODS_TIMERS
} ods_timer_t;

/* What the end of the turn has to look at. */
#define ODS_WORK_EMCY 0x01u /* an emergency is queued, or may leave now */
#define ODS_WORK_HEARTBEAT 0x02u
#define ODS_WORK_TPDO 0x04u /* a TPDO is due, or a value that one may carry has changed */
#define ODS_WORK_OUTPUT 0x08u /* an LED or an output may have changed */
#define ODS_WORK_ERROR_BEHAVIOUR 0x10u /* 1029h: the NMT state follows an error */

/* The SDO server. A transfer goes on while `phase` is not 0. */
typedef struct {
    ods_od_ref_t ref;
    const uint8_t *source; /* of an upload */
    uint32_t address; /* of what is being written: index, sub-index << 16; of no meaning for an RPDO */
    uint16_t index;
    uint16_t length; /* octets in all; of a download whose size is not told the most that fit */
    uint16_t done; /* octets so far */
    uint8_t sub;
    uint8_t phase;
    uint8_t toggle;
    uint8_t sized; /* the client told the size */
} ods_sdo_t;

/* Heartbeat and guarding. */
#define ODS_CONSUMERS 4u

typedef struct {
    uint32_t life_ticks; /* of the life time: those that remain when its timer runs out */
    uint8_t lost; /* heartbeats that are missing: bit 1 << (sub-index of 1016h - 1); bit 7: the master's guarding */
    uint8_t toggle; /* bit 7 of the next guarding answer */
} ods_heartbeat_t;

/* Emergencies. */
typedef struct {
    uint8_t row; /* in device->emergencies */
    uint8_t axis; /* or 255 */
    uint8_t error_register;
} ods_emcy_item_t;

#define ODS_EMCY_QUEUE 8u

typedef struct {
    uint32_t conditions; /* those of the whole device that hold: bit 1 << ods_condition_t */
    uint32_t warnings; /* conditions that warn, whether they hold or not */
    uint32_t faults; /* conditions that are a fault */
    ods_emcy_item_t queue[ODS_EMCY_QUEUE];
    uint8_t first;
    uint8_t count;
} ods_emcy_t;

typedef struct {
    uint8_t row; /* in device->leds; ODS_NONE: dark */
    uint8_t phase;
    uint8_t on;
} ods_led_state_t;

/* Inputs and outputs of the whole module: inputs as they are, which a tick samples; outputs as they were last told. */
#define ODS_ANALOG_CHANNELS 8u

typedef struct {
    uint32_t digital_inputs;
    uint32_t analog_inputs[ODS_ANALOG_CHANNELS];
    uint32_t masked_outputs; /* of outputs with a mask: the state that is kept while the mask leaves one out */
    uint32_t digital_outputs;
    int16_t analog_outputs[ODS_ANALOG_CHANNELS];
    uint8_t address;
    uint8_t enable;
    uint8_t is_new; /* an input has changed since the last tick */
} ods_io_t;

/* The record of stored values. */
typedef struct {
    uint8_t bank; /* the one in force, 0 or 1; ODS_NONE if there is no valid record */
    uint16_t sequence; /* of its record */
} ods_store_t;

/*
 * A mapped entry, found once, when the mapping comes into force. It belongs to the device or to an axis, so the number
 * of its instance is small.
 */
typedef struct {
    uint16_t at; /* of a TPDO: octets from the beginning of the values; of an RPDO: its number in od->entries */
    uint8_t instance;
    uint8_t place; /* its first octet in the frame; << 4 the binary logarithm of its size */
} ods_pdo_ref_t;

#define ODS_PDO_BUCKETS 16u

/* What RPDOs and TPDOs have in common. */
typedef struct {
    ods_pdo_values_t *values; /* its parameters */
    ods_pdo_ref_t *refs;
    uint8_t mapped; /* entries in force; 0 while the PDO is inactive */
    uint8_t length; /* octets of its frame */
    uint8_t syncs; /* SYNCs since the last transmission or application */
    uint8_t flags;
} ods_pdo_common_t;

typedef struct ods_rpdo {
    ods_pdo_common_t pdo;
    struct ods_rpdo *next; /* the next active one whose CAN-ID falls into the same bucket */
    struct ods_rpdo *next_synchronous;
    uint8_t held[8]; /* the newest frame, until its SYNC comes */
} ods_rpdo_t;

typedef struct ods_tpdo {
    ods_pdo_common_t pdo;
    struct ods_tpdo *next; /* the next active one of its kind: either synchronous or not */
    uint32_t watched; /* what it carries values of, see ods_node_t.changed */
    uint32_t event_at; /* its event timer runs out */
    uint32_t sent_at; /* its last transmission, unless that is long ago */
    uint8_t image[8]; /* as last sent */
} ods_tpdo_t;

/* Active PDOs are chained in ascending order, so that nothing has to look at the others. */
typedef struct {
    ods_rpdo_t *rpdos;
    ods_tpdo_t *tpdos;
    ods_pdo_ref_t *mapped; /* od->max_mapped for each RPDO, then for each TPDO */
    ods_rpdo_t *buckets[ODS_PDO_BUCKETS]; /* the first active RPDO of each */
    ods_rpdo_t *synchronous_rpdos;
    ods_tpdo_t *synchronous_tpdos;
    ods_tpdo_t *event_tpdos;
    uint32_t watched; /* by any active TPDO */
    uint32_t aged_at; /* when transmissions that are long ago were last forgotten */
} ods_pdo_t;

/* The encoder of an axis: where the shaft really is. */
typedef struct {
    int64_t velocity; /* 1/1000 microstep per second */
    int64_t increments; /* since the position was the origin */
    int32_t origin;
    int32_t count; /* as last read */
    int32_t position; /* microsteps */
    uint8_t is_index; /* the level of the index line is the active one */
    uint8_t has_pulse; /* since this tick */
} ods_encoder_t;

/* A homing. */
typedef struct {
    const ods_homing_row_t *method; /* while the phase is not 0 */
    uint16_t status; /* bits 10 and 12 of the statusword */
    int8_t direction; /* of the search */
    uint8_t phase;
    uint8_t was_active; /* the switch, on the way over its edge */
    uint8_t has_reversed;
} ods_homing_t;

/* The cyclic modes. */
typedef struct {
    uint32_t ticks; /* that remain until the last set-point has to be reached */
    uint8_t is_following; /* since the first set-point */
} ods_cyclic_t;

/* An axis. What its flags say is in ods_axis.h. */
typedef struct {
    ods_axis_values_t *values; /* in the dictionary */

    int64_t position; /* 1/1,000,000 microstep */
    int64_t velocity; /* 1/1000 microstep per second */
    int64_t far; /* profile position: a distance from which on the target says but the direction */
    int32_t demand; /* the position in whole microsteps */
    int32_t steps; /* microsteps of this tick */
    int32_t target; /* of profile position, in microsteps */

    ods_motor_answer_t answer; /* what the hardware said last */
    uint32_t faults; /* conditions that were reported beside it: bit 1 << ods_condition_t */
    uint32_t conditions; /* those that hold since the last tick */
    uint32_t limits; /* limits that were found at its end */

    uint32_t flags;
    uint32_t begun; /* when the phase began, in microseconds */
    uint32_t still; /* ticks at standstill, as far as the setting delay counts them */
    uint32_t faded_us; /* since the current last fell */
    uint32_t outputs; /* as last told: an octet for each */

    uint16_t word; /* the last controlword */
    uint16_t before; /* the one before it, while it waits */
    uint16_t delay; /* ticks that the phase still takes */
    uint16_t wait; /* ticks of the pause at standstill */
    uint16_t inside; /* ticks in the position window without a break */
    uint16_t slow_down_ramp; /* offset of that of the last mode that has one; ODS_NOWHERE: none yet */
    uint16_t shown_state; /* what the statusword shows of the state */
    int16_t quick_stop; /* option code of the quick stop that is active */

    uint8_t number;
    int8_t fresh; /* the mode of a set-point that was taken since the last tick; 0: none was */
    uint8_t state; /* ods_pds_state_t */
    uint8_t goal; /* where transition 5 leads, while it takes time */
    uint8_t phase; /* what a transition waits for */
    uint8_t stop; /* whether the state machine stops the axis, and on which slope */
    uint8_t current; /* in steps of the driver */
    uint8_t driver; /* ODS_DRIVER_... */

    ods_encoder_t encoder;
    ods_homing_t homing;
    ods_cyclic_t cyclic;
} ods_axis_t;

typedef struct ods_node {
    const ods_device_t *device;
    const ods_od_t *od;
    const ods_port_t *port;
    uint8_t *values; /* the block of the dictionary's values */
    ods_device_values_t *common; /* those of the device */
    ods_axis_t *axes;
    uint8_t *buffer; /* od->buffer_size octets: a value on its way */
    ods_config_t config;

    uint32_t now;
    uint32_t wake; /* nothing is due before */
    uint32_t armed; /* bit 1 << ods_timer_t */
    uint32_t deadlines[ODS_TIMERS];
    uint32_t changed; /* values that a TPDO carries and that have changed, see ods_instance_bit() */

    uint8_t work; /* ODS_WORK_... */
    uint8_t id; /* the node-ID in force */
    uint8_t state; /* ods_nmt_state_t */
    uint8_t services; /* ODS_SERVICE_... of the state */
    uint8_t can; /* ods_can_t: the state of the controller */
    uint8_t next_state; /* of ODS_WORK_ERROR_BEHAVIOUR */

    ods_sdo_t sdo;
    ods_heartbeat_t heartbeat;
    ods_emcy_t emcy;
    ods_led_state_t leds[ODS_LEDS];
    ods_io_t io;
    ods_store_t store;
    ods_pdo_t pdo;
} ods_node_t;

/* The memory of a node, sized by the generated header; all of it has to outlive the node. */
typedef struct {
    void *values; /* od->values_size octets, aligned as any struct of the dictionary */
    ods_axis_t *axes; /* device->axes */
    ods_rpdo_t *rpdos;
    ods_tpdo_t *tpdos;
    ods_pdo_ref_t *mapped;
    uint8_t *buffer; /* od->buffer_size */
} ods_memory_t;

/* ---- functions --------------------------------------------------------------------------------------------------- */

/*
 * Tie a node to its device, memory and port. The generated header has a function that does so for its device.
 * `port` and `device` have to outlive the node.
 */
void ods_node_init(
    ods_node_t *node,
    const ods_device_t *device,
    const ods_memory_t *memory,
    const ods_port_t *port,
    const ods_config_t *config);

/* Power comes up. Before it only ods_node_input(), ods_node_fault() and ods_node_motor() may be called. */
void ods_node_power_on(ods_node_t *node, uint32_t now);

/* A frame was received. */
void ods_node_receive(ods_node_t *node, uint32_t now, const ods_frame_t *frame);

/* Time has passed. */
void ods_node_advance(ods_node_t *node, uint32_t now);

/* The next instant at which the node has something to do. Returns 0 if there is none, and leaves `at` alone. */
int ods_node_next(const ods_node_t *node, uint32_t *at);

/* An input has a new value. `channel` counts from 0; it is 0 where there is only one. Unknown ones are ignored. */
void ods_node_input(ods_node_t *node, uint32_t now, ods_input_t input, uint8_t channel, uint32_t value);

/* The hardware of an axis reports that a condition holds or has ended. Acts at the next tick. */
void ods_node_fault(ods_node_t *node, uint32_t now, uint8_t axis, ods_condition_t condition, int holds);

/*
 * The hardware of an axis has something new to say, outside of the port's callback `motor`. Acts at the next tick.
 * What `ods_node_fault()` reported holds beside it.
 */
void ods_node_motor(ods_node_t *node, uint32_t now, uint8_t axis, const ods_motor_answer_t *answer);

/* The CAN controller changed its state, or something happened to it. */
void ods_node_can(ods_node_t *node, uint32_t now, ods_can_t event);

/*
 * Read an entry as an SDO upload would, without a bus. Returns 0, or an SDO abort code. `octets` has room for `size`
 * octets, ODS_ABORT_OUT_OF_MEMORY if they do not suffice; `length` becomes the number of octets, little-endian.
 */
uint32_t ods_node_read(
    const ods_node_t *node, uint16_t index, uint8_t sub, uint8_t *octets, uint16_t size, uint16_t *length);

/* Octets of non-volatile memory that the device uses. */
uint32_t ods_store_size(const ods_device_t *device);

#ifdef __cplusplus
}
#endif

#endif
