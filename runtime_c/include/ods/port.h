/*
 * The border between a node and its hardware.
 *
 * A node never waits, never reads a clock and never touches a register. The firmware hands it frames, inputs and the
 * time; what the node wants done it asks for through the callbacks of a port. Each of them gets the port's `context`,
 * so several nodes can run in one program.
 *
 * Time is a count of microseconds in 32 bits, which wraps.
 */
#ifndef ODS_PORT_H
#define ODS_PORT_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A CAN frame with an 11 bit CAN-ID. Others are no business of a node: leave them out. */
typedef struct {
    uint16_t id;
    uint8_t length; /* DLC, 0 to 8 */
    uint8_t remote; /* 1: a remote frame, without data */
    uint8_t data[8];
} ods_frame_t;

/* What a device puts out beside frames, in the order in which changes are told. */
typedef enum {
    ODS_OUTPUT_RUN_LED, /* 0 or 1 */
    ODS_OUTPUT_ERROR_LED, /* 0 or 1 */
    ODS_OUTPUT_DIGITAL, /* general purpose outputs: bit n is OUTn */
    ODS_OUTPUT_ANALOG, /* analog output `channel`, an int16_t */
    ODS_OUTPUT_POWER, /* power stage of axis `channel`, 0 or 1; from here on 0 at power-on without being told */
    ODS_OUTPUT_BRAKE, /* current into the brake of axis `channel`, 0 to 255 as in 200Ch */
    ODS_OUTPUT_CURRENT, /* current of motor `channel` in 32nds of the full one; 0: the motor turns freely */
    ODS_OUTPUT_DRIVER, /* how driver `channel` runs its motor: ODS_DRIVER_... */
    ODS_OUTPUTS
} ods_output_t;

/* What the driver of a motor does at the present speed. */
#define ODS_DRIVER_COOL_STEP 0x01u /* faster than 20A5h: the current follows the load */
#define ODS_DRIVER_STEALTH_CHOP 0x02u /* slower than 20B0h */
#define ODS_DRIVER_DC_STEP 0x04u /* not slower than 20B3h, unless that is 0 */
#define ODS_DRIVER_HIGH_SPEED 0x08u /* faster than 20B6h: what 20B7h and 20B8h ask for */

/* What comes in beside frames. All of it but the address acts at the next tick, as if it were sampled there. */
typedef enum {
    ODS_INPUT_ADDRESS, /* the address switches, 0 without any; read at power-on and reset node */
    ODS_INPUT_ENABLE, /* the enable input of the module, 1 at power-on; 0 is the condition `shutdown_switch` */
    ODS_INPUT_DIGITAL, /* general purpose inputs: bit n is INn */
    ODS_INPUT_ANALOG, /* a reading of analog input `channel`, 16 bits; more counts as FFFFh */
    ODS_INPUTS
} ods_input_t;

/* Lines of an axis, as they are: what 2005h says of them is the business of the node. */
#define ODS_LINE_LEFT 0x01u /* limit switch of the negative direction */
#define ODS_LINE_RIGHT 0x02u /* limit switch of the positive direction */
#define ODS_LINE_HOME 0x04u
#define ODS_LINE_INDEX 0x08u /* N channel of the encoder */

/* What an axis asks of its motor in a tick. */
typedef struct {
    int32_t steps; /* microsteps to make in this tick, negative backwards */
    int32_t velocity; /* at its end, in microsteps per second */
} ods_motor_demand_t;

/* What the hardware of an axis has to say, sampled by the next tick. It stays so until somebody changes it. */
typedef struct {
    uint32_t faults; /* conditions that hold: bit 1 << ods_condition_t */
    int32_t encoder; /* count of increments, which wraps */
    int32_t velocity; /* measured by the driver, in microsteps per second (2122h) */
    uint16_t load; /* measured by the driver: 1023 idle, 0 stalled (2101h) */
    uint8_t pwm_scale; /* of the driver in stealthChop (2121h) */
    uint8_t lines; /* ODS_LINE_... */
} ods_motor_answer_t;

/* States of the CAN controller, each worse than the one before, and what can happen to it. */
typedef enum {
    ODS_CAN_OK, /* error active */
    ODS_CAN_WARNING, /* an error counter is at 96 or above */
    ODS_CAN_PASSIVE, /* error passive */
    ODS_CAN_BUS_OFF, /* nothing is received, nothing can be sent */
    ODS_CAN_ERROR, /* an event: the controller reports an error of the bus */
    ODS_CAN_OVERRUN, /* an event: a frame was lost in the controller */
    ODS_CAN_TX_FULL, /* an event: a frame was lost because the transmit queue was full */
    ODS_CAN_RX_FULL /* an event: a frame was lost because the receive queue was full */
} ods_can_t;

/* The seven octets of a command, and of its reply (1023h). */
#define ODS_OS_COMMAND_SIZE 7u

/* How a command ended, as 1023h:02 shows it (CiA 301, 7.5.2.26). */
typedef enum {
    ODS_OS_DONE = 0,
    ODS_OS_DONE_WITH_REPLY = 1,
    ODS_OS_FAILED = 2,
    ODS_OS_FAILED_WITH_REPLY = 3
} ods_os_status_t;

/*
 * What the firmware provides. Only `send` is a must; NULL elsewhere means that the hardware lacks it. No callback may
 * call a function of the same node.
 */
typedef struct {
    void *context;

    /* Take a frame for sending. Frames leave in the order of the calls. */
    void (*send)(void *context, const ods_frame_t *frame);

    /* Set an output. Called only when the value changes, and for every output at power-on. */
    void (*output)(void *context, ods_output_t output, uint8_t channel, uint32_t value);

    /* Join the bus at a bit rate in kbit/s under a node-ID: at power-on and reset node, before the boot-up frame. */
    void (*bus)(void *context, uint16_t bit_rate, uint8_t node_id);

    /*
     * Non-volatile memory of at least `ods_store_size()` octets, from address 0. An octet that was never written may
     * read as anything. A write has to be complete when the call returns: it is the only moment at which power may be
     * lost without a trace of it. Both return 0 on success.
     */
    int (*nvm_read)(void *context, uint32_t address, uint8_t *octet);
    int (*nvm_write)(void *context, uint32_t address, uint8_t octet);

    /*
     * Set a parameter of the motor driver of an axis, which is the value of the object with this index in axis 0: when
     * it is written, and all of them at power-on and reset node.
     */
    void (*motor_set)(void *context, uint8_t axis, uint16_t parameter, int32_t value);

    /*
     * A tick of an axis is over: make its steps, and say what the hardware has to say to the next tick. Called in each
     * tick for every axis, in ascending order, after all axes have been worked off; not called while nothing moves.
     */
    void (*motor)(void *context, uint8_t axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer);

    /*
     * Carry out the command of 1023h and fill in the reply, which is all 0 before. Without this callback every command
     * ends as ODS_OS_FAILED.
     */
    ods_os_status_t (*os_command)(
        void *context, const uint8_t command[ODS_OS_COMMAND_SIZE], uint8_t reply[ODS_OS_COMMAND_SIZE]);
} ods_port_t;

#ifdef __cplusplus
}
#endif

#endif
