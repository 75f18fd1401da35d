/*
 * What a board has to bring along, and what its interrupt handlers call. The functions called board_... have no body
 * here on purpose: the linker names those that are still to be written.
 */
#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

#include "ods/port.h"

/* ---- to be written for the board; main.c calls them from the main loop --------------------------------------- */

/* Clocks, pins, timers, the CAN controller without joining the bus. The motors are without power. */
void board_start(void);

/* A count of microseconds that runs freely and wraps after 2^32. */
uint32_t board_time_us(void);

/* Sleep until the next interrupt (`WFI`). One has to come within 1 ms, from SysTick for instance. */
void board_wait(void);

/* Go on the bus at so many kbit/s, or leave it and come back at another bit rate. Let all 11 bit CAN-IDs in. */
void board_can_start(uint16_t bit_rate);

/* There are frames to send: let the interrupt for an empty transmit buffer come. */
void board_can_send(void);

/* Non-volatile memory, see ods/port.h. Both return 0 on success. */
int board_nvm_read(uint32_t address, uint8_t *octet);
int board_nvm_write(uint32_t address, uint8_t octet);

void board_set_output(ods_output_t output, uint8_t channel, uint32_t value);

/* Parameters and motion of an axis, see motor_set and motor in ods/port.h. */
void board_motor_set(uint8_t axis, uint16_t parameter, int32_t value);
void board_motor(uint8_t axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer);

/* The input lines: bit n is INn, 1 is active. */
uint32_t board_digital_inputs(void);

/* The address switches, 0 without any; and the serial number that the factory gave. */
uint8_t board_address(void);
uint32_t board_serial_number(void);

/* ---- to be called by the interrupt handlers of the board, all at one priority ------------------------------ */

/* A frame was received. */
void main_can_received(const ods_frame_t *frame);

/* The transmit buffer is empty: 1 and the next frame, or 0 if there is none; the handler then ends the interrupt. */
int main_can_next(ods_frame_t *frame);

/* The controller changed its state, or something happened to it. */
void main_can_report(ods_can_t what);

#endif
