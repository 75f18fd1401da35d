/*
 * A node on a Cortex-M without an operating system: the main loop, and the port between it and the board.
 *
 * Interrupt handlers fill queues; the node runs in the main loop alone, and is never interrupted by itself.
 */
#include "board.h"
#include "frame_queue.h"
#include "tmcm6212.h"

#define CAN_EVENTS 4u /* from ODS_CAN_ERROR on; what stands before are states */

static tmcm6212_t drive;
static frame_queue_t received;
static frame_queue_t to_send;
static volatile uint8_t can_state;
static volatile uint8_t can_events[CAN_EVENTS]; /* each counts how often it happened */

/* ---- what the interrupt handlers call ------------------------------------------------------------------------ */

void main_can_received(const ods_frame_t *frame)
{
    frame_queue_put(&received, frame);
}

int main_can_next(ods_frame_t *frame)
{
    return frame_queue_take(&to_send, frame);
}

void main_can_report(ods_can_t what)
{
    if (what < ODS_CAN_ERROR) {
        can_state = (uint8_t)what;
    } else if (what < ODS_CAN_ERROR + CAN_EVENTS) {
        can_events[what - ODS_CAN_ERROR]++;
    }
}

/* ---- what the node calls --------------------------------------------------------------------------------------- */

static void send_frame(void *context, const ods_frame_t *frame)
{
    (void)context;
    frame_queue_put(&to_send, frame);
    board_can_send();
}

static void set_output(void *context, ods_output_t output, uint8_t channel, uint32_t value)
{
    (void)context;
    board_set_output(output, channel, value);
}

static void join_bus(void *context, uint16_t bit_rate, uint8_t node_id)
{
    (void)context;
    (void)node_id; /* a filter for it would have to let in all that PDOs and heartbeat consumers ask for */
    board_can_start(bit_rate);
}

static int read_nvm(void *context, uint32_t address, uint8_t *octet)
{
    (void)context;
    return board_nvm_read(address, octet);
}

static int write_nvm(void *context, uint32_t address, uint8_t octet)
{
    (void)context;
    return board_nvm_write(address, octet);
}

static void set_motor(void *context, uint8_t axis, uint16_t parameter, int32_t value)
{
    (void)context;
    board_motor_set(axis, parameter, value);
}

static void drive_motor(void *context, uint8_t axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer)
{
    (void)context;
    board_motor(axis, demand, answer);
}

/* ---- the main loop --------------------------------------------------------------------------------------------- */

static void receive_frames(void)
{
    ods_frame_t frame;

    for (uint32_t i = 0; (i < FRAME_QUEUE_SIZE) && frame_queue_take(&received, &frame); i++) {
        ods_node_receive(&drive.node, board_time_us(), &frame);
    }
}

/* Tell the node once if a counter has moved. */
static void pass_on(uint8_t count, uint8_t *seen, ods_can_t event)
{
    if (count != *seen) {
        *seen = count;
        ods_node_can(&drive.node, board_time_us(), event);
    }
}

static void report_can(void)
{
    static uint8_t state = ODS_CAN_OK;
    static uint8_t events[CAN_EVENTS];
    static uint8_t lost_received;
    static uint8_t lost_to_send;
    const uint8_t now = can_state;

    if (now != state) {
        state = now;
        ods_node_can(&drive.node, board_time_us(), (ods_can_t)now);
    }
    for (uint32_t i = 0; i < CAN_EVENTS; i++) {
        pass_on(can_events[i], &events[i], (ods_can_t)(ODS_CAN_ERROR + i));
    }
    pass_on(received.lost, &lost_received, ODS_CAN_RX_FULL);
    pass_on(to_send.lost, &lost_to_send, ODS_CAN_TX_FULL);
}

static void sample_inputs(void)
{
    static uint32_t seen;
    const uint32_t inputs = board_digital_inputs();

    if (inputs != seen) {
        seen = inputs;
        ods_node_input(&drive.node, board_time_us(), ODS_INPUT_DIGITAL, 0, inputs);
    }
}

int main(void)
{
    static const ods_port_t port = {
        .send = send_frame,
        .output = set_output,
        .bus = join_bus,
        .nvm_read = read_nvm,
        .nvm_write = write_nvm,
        .motor_set = set_motor,
        .motor = drive_motor,
    };
    ods_config_t config = { 0 };

    board_start();
    config.serial_number = board_serial_number();
    tmcm6212_init(&drive, &port, &config);
    ods_node_input(&drive.node, board_time_us(), ODS_INPUT_ADDRESS, 0, board_address());
    ods_node_power_on(&drive.node, board_time_us());
    for (;;) {
        receive_frames();
        report_can();
        sample_inputs();
        ods_node_advance(&drive.node, board_time_us());
        board_wait();
    }
}
