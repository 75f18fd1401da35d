/*
 * A node on a CAN bus of Linux.
 *
 *     ip link set can0 up type can bitrate 1000000 restart-ms 100      once, as root
 *     ./tmcm6212_linux can0 values.nvm
 *
 * A change of the bit rate (CiA 301 leaves it to the device, see its manual) cannot be carried out here: a program may
 * not set up an interface. It is printed, and `ip link` does it.
 */
#define _GNU_SOURCE /* ppoll */

#include "nvm_file.h"
#include "socketcan.h"
#include "tmcm6212.h"

#include <errno.h>
#include <poll.h>
#include <time.h>
#include <unistd.h>

#define US_PER_S 1000000u
#define NS_PER_US 1000u
#define LONGEST_WAIT US_PER_S /* us */
#define BURST 64 /* frames that are taken before time goes on */

typedef struct {
    tmcm6212_t drive;
    FILE *nvm;
    int bus;
    uint32_t lost; /* frames for which the driver had no room */
    uint8_t unsaved; /* written, but perhaps not yet on the disk */
} board_t;

static uint32_t now_us(void)
{
    struct timespec time;

    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint32_t)((uint64_t)time.tv_sec * US_PER_S + (uint64_t)time.tv_nsec / NS_PER_US);
}

/*
 * Whoever gets an answer may rely on what was stored, so the disk comes first. That octets may reach it in another
 * order than they were written in does no harm: a record counts only if its CRC is right.
 */
static void send_frame(void *context, const ods_frame_t *frame)
{
    board_t *const board = context;

    if (board->unsaved != 0u) {
        (void)fdatasync(fileno(board->nvm));
        board->unsaved = 0;
    }
    if (socketcan_write(board->bus, frame) != 0) {
        board->lost++;
    }
}

static void join_bus(void *context, uint16_t bit_rate, uint8_t node_id)
{
    (void)context;
    (void)fprintf(stderr, "node %u, to be at %u kbit/s\n", (unsigned)node_id, (unsigned)bit_rate);
}

static int read_nvm(void *context, uint32_t address, uint8_t *octet)
{
    const board_t *const board = context;

    return nvm_file_read(board->nvm, address, octet);
}

static int write_nvm(void *context, uint32_t address, uint8_t octet)
{
    board_t *const board = context;

    board->unsaved = 1;
    return nvm_file_write(board->nvm, address, octet);
}

/* Sleep until something comes from the bus, or the node has something to do. */
static void wait_for_work(const board_t *board)
{
    struct pollfd bus = { .fd = board->bus, .events = POLLIN };
    uint32_t wait = LONGEST_WAIT;
    uint32_t at;

    if (ods_node_next(&board->drive.node, &at)) {
        const uint32_t left = at - now_us();
        if ((left < wait) || ((int32_t)left < 0)) {
            wait = ((int32_t)left < 0) ? 0 : left;
        }
    }
    const struct timespec timeout = { .tv_sec = (time_t)(wait / US_PER_S),
                                      .tv_nsec = (long)(wait % US_PER_S * NS_PER_US) };
    (void)ppoll(&bus, 1, &timeout, NULL);
}

static void obey(board_t *board, const struct can_frame *frame)
{
    ods_can_t events[SOCKETCAN_EVENTS];
    ods_frame_t known;
    const uint32_t count = socketcan_events(frame, events);

    for (uint32_t i = 0; i < count; i++) {
        ods_node_can(&board->drive.node, now_us(), events[i]);
    }
    if (socketcan_frame(frame, &known)) {
        ods_node_receive(&board->drive.node, now_us(), &known);
    }
}

/* Returns only if the bus cannot be read any more. */
static void run(board_t *board)
{
    struct can_frame frame;
    int got = 0;

    while (got >= 0) {
        wait_for_work(board);
        for (int i = 0; (i < BURST) && ((got = socketcan_read(board->bus, &frame)) > 0); i++) {
            obey(board, &frame);
        }
        if (board->lost > 0u) {
            board->lost = 0;
            ods_node_can(&board->drive.node, now_us(), ODS_CAN_TX_FULL);
        }
        ods_node_advance(&board->drive.node, now_us());
    }
}

int main(int argc, char **argv)
{
    static board_t board;
    const ods_port_t port = {
        .context = &board,
        .send = send_frame,
        .bus = join_bus,
        .nvm_read = read_nvm,
        .nvm_write = write_nvm,
    };
    const ods_config_t config = { .serial_number = 1 };

    if (argc != 3) {
        (void)fprintf(stderr, "usage: %s INTERFACE NVM_FILE\n", argv[0]);
        return 2;
    }
    board.bus = socketcan_open(argv[1]);
    if (board.bus < 0) {
        perror(argv[1]);
        return 2;
    }
    board.nvm = nvm_file_open(argv[2]);
    if (board.nvm == NULL) {
        perror(argv[2]);
        return 2;
    }
    tmcm6212_init(&board.drive, &port, &config);
    ods_node_power_on(&board.drive.node, now_us());
    run(&board);
    perror(argv[1]);
    return 1;
}
