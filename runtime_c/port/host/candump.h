/*
 * CAN frames as lines of text, in the form that `candump -L` of can-utils writes and `canplayer` reads:
 *
 *     (0000000012.345678) can0 601#4000100000000000      a stamp in seconds, a bus, CAN-ID # data
 *     701#R                                              a remote frame; its DLC may follow the R
 *
 * Stamp and bus may be left out when read, and a stamp may stand alone.
 */
#ifndef CANDUMP_H
#define CANDUMP_H

#include <stdint.h>
#include <stdio.h>

#include "ods/port.h"

#define CANDUMP_LINE 128u /* octets that hold any line, its end included */

typedef enum {
    CANDUMP_FRAME,
    CANDUMP_NO_FRAME, /* nothing, a stamp alone, or a frame that is none for a node: 29 bit CAN-ID, error, CAN FD */
    CANDUMP_WRONG
} candump_line_t;

/* What stands in a line. `time`, in microseconds, stays as it is if the line has no stamp. */
candump_line_t candump_read(const char *line, uint64_t *time, ods_frame_t *frame);

void candump_write(FILE *stream, uint64_t time, const ods_frame_t *frame);

#endif
