/*
 * A node on no hardware at all: it reads what happens on a bus, line by line, and prints what it sends.
 *
 *     echo '601#4000100000000000' | ./tmcm6212_host
 *     ./tmcm6212_host values.nvm < recorded.log
 *
 * The lines are those of candump.h. Time is what their stamps say and stands still in between, so that the same lines
 * give the same answer on any day. The first line switches the power on. Stored values are kept in the file that the
 * command line names; without one the device has no memory for them.
 */
#include "candump.h"
#include "nvm_file.h"
#include "tmcm6212.h"

#include <string.h>

#define LONGEST_STEP (1u << 30) /* us; see ods_node_advance() */

typedef struct {
    tmcm6212_t drive;
    FILE *nvm;
    uint64_t now; /* us; the node sees the lower half */
} host_t;

static void send_frame(void *context, const ods_frame_t *frame)
{
    const host_t *const host = context;

    candump_write(stdout, host->now, frame);
}

static void join_bus(void *context, uint16_t bit_rate, uint8_t node_id)
{
    (void)context;
    (void)fprintf(stderr, "node %u at %u kbit/s\n", (unsigned)node_id, (unsigned)bit_rate);
}

static int read_nvm(void *context, uint32_t address, uint8_t *octet)
{
    const host_t *const host = context;

    return nvm_file_read(host->nvm, address, octet);
}

static int write_nvm(void *context, uint32_t address, uint8_t octet)
{
    const host_t *const host = context;

    return nvm_file_write(host->nvm, address, octet);
}

/* Let time pass, and stop wherever the node has something to do, so that its frames get the right stamps. */
static void run_until(host_t *host, uint64_t until)
{
    while (host->now < until) {
        const uint64_t left = until - host->now;
        uint32_t step = (left < LONGEST_STEP) ? (uint32_t)left : LONGEST_STEP;
        uint32_t at;

        if (ods_node_next(&host->drive.node, &at) && ((at - (uint32_t)host->now - 1u) < step)) {
            step = at - (uint32_t)host->now;
        }
        host->now += step;
        ods_node_advance(&host->drive.node, (uint32_t)host->now);
    }
}

/* Carry out one line. Returns 0 where it cannot be read. */
static int obey(host_t *host, const char *line, int first)
{
    uint64_t time = host->now;
    ods_frame_t frame;
    const candump_line_t found = candump_read(line, &time, &frame);

    if (first) {
        host->now = time;
        ods_node_power_on(&host->drive.node, (uint32_t)host->now);
    }
    run_until(host, time); /* a stamp of the past is taken for now */
    if (found == CANDUMP_FRAME) {
        ods_node_receive(&host->drive.node, (uint32_t)host->now, &frame);
    }
    return found != CANDUMP_WRONG;
}

static int run(host_t *host, FILE *input)
{
    char line[CANDUMP_LINE];
    unsigned long number = 0;
    int status = 0;

    while (fgets(line, sizeof(line), input) != NULL) {
        number++;
        if (!obey(host, line, number == 1u)) {
            (void)fprintf(stderr, "line %lu: this is not a frame\n", number);
            status = 1;
        }
        (void)fflush(stdout);
    }
    return status;
}

int main(int argc, char **argv)
{
    static host_t host;
    ods_port_t port = { .context = &host, .send = send_frame, .bus = join_bus };
    const ods_config_t config = { .serial_number = 1 };

    if (argc > 2) {
        (void)fprintf(stderr, "usage: %s [NVM_FILE] < LINES\n", argv[0]);
        return 2;
    }
    if (argc == 2) {
        host.nvm = nvm_file_open(argv[1]);
        if (host.nvm == NULL) {
            perror(argv[1]);
            return 2;
        }
        port.nvm_read = read_nvm;
        port.nvm_write = write_nvm;
    }
    tmcm6212_init(&host.drive, &port, &config);
    return run(&host, stdin);
}
