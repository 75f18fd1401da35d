/*
 * A board for port/cortex_m that exists only here: the CAN controller is the standard input and output, in the lines of
 * port/host/candump.h, and each millisecond of sleep brings the next line. `!name value` is the board's own.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "board.h"
#include "candump.h"

static uint32_t now;
static uint32_t inputs;
static uint8_t nvm[8192];

void board_start(void)
{
    puts("start");
}

uint32_t board_time_us(void)
{
    return now;
}

void board_can_start(uint16_t bit_rate)
{
    printf("bus %u\n", (unsigned)bit_rate);
}

void board_can_send(void)
{
}

int board_nvm_read(uint32_t address, uint8_t *octet)
{
    *octet = nvm[address];
    return 0;
}

int board_nvm_write(uint32_t address, uint8_t octet)
{
    nvm[address] = octet;
    return 0;
}

void board_set_output(ods_output_t output, uint8_t channel, uint32_t value)
{
    if (output == ODS_OUTPUT_DIGITAL) {
        printf("output %u %lu\n", (unsigned)channel, (unsigned long)value);
    }
}

/* A motor that goes where it is told, and says nothing of it. */
void board_motor_set(uint8_t axis, uint16_t parameter, int32_t value)
{
    (void)axis;
    (void)parameter;
    (void)value;
}

void board_motor(uint8_t axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer)
{
    (void)axis;
    (void)demand;
    (void)answer;
}

uint32_t board_digital_inputs(void)
{
    return inputs;
}

uint8_t board_address(void)
{
    return 9;
}

uint32_t board_serial_number(void)
{
    return 0x01020304u;
}

/* The interrupts of a millisecond: the transmit buffer empties, then comes what the line says. */
void board_wait(void)
{
    char line[CANDUMP_LINE];
    char name[16];
    unsigned long value;
    uint64_t time = 0;
    ods_frame_t frame;

    while (main_can_next(&frame)) {
        candump_write(stdout, now, &frame);
    }
    if (fgets(line, sizeof(line), stdin) == NULL) {
        exit(0);
    }
    now += 1000u;
    if (sscanf(line, "!%15s %lu", name, &value) == 2) {
        if (strcmp(name, "inputs") == 0) {
            inputs = (uint32_t)value;
        } else if (strcmp(name, "can") == 0) {
            main_can_report((ods_can_t)value);
        } else if (strcmp(name, "flood") == 0) {
            memset(&frame, 0, sizeof(frame));
            frame.id = 0x123;
            while (value-- > 0u) {
                main_can_received(&frame);
            }
        }
    } else if (candump_read(line, &time, &frame) == CANDUMP_FRAME) {
        main_can_received(&frame);
    }
}
