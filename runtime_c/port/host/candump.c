#include "candump.h"

#include <inttypes.h>
#include <string.h>

#define US_PER_S 1000000u

#define STAMP_DIGITS 12u /* of the seconds; so many fit into 64 bits of microseconds */
#define ID_DIGITS 3u
#define LONG_ID_DIGITS 8u /* a 29 bit CAN-ID, or an error frame */
#define ID_MAX 0x7FFu
#define DATA_MAX 8u

static int is_blank(char c)
{
    return (c == ' ') || (c == '\t');
}

static int is_end(char c)
{
    return (c == '\0') || (c == '\n') || (c == '\r');
}

static const char *skip_blanks(const char *at)
{
    while (is_blank(*at)) {
        at++;
    }
    return at;
}

static const char *skip_word(const char *at)
{
    while (!is_blank(*at) && !is_end(*at)) {
        at++;
    }
    return at;
}

/* The value of a digit, or -1. */
static int digit(char c, unsigned base)
{
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    const char *const found = (c == '\0') ? NULL : strchr(digits, c);
    const int value = (found == NULL) ? -1 : (int)((found - digits) % 16);

    return (value < (int)base) ? value : -1;
}

/* Read up to `most` digits, and give how many there were. */
static unsigned number(const char **at, unsigned base, unsigned most, uint64_t *value)
{
    unsigned digits = 0;

    *value = 0;
    while ((digits < most) && (digit(**at, base) >= 0)) {
        *value = (*value * base) + (uint64_t)digit(**at, base);
        *at += 1;
        digits++;
    }
    return digits;
}

static int read_stamp(const char **at, uint64_t *time)
{
    uint64_t seconds;
    uint64_t fraction;

    *at += 1;
    if ((number(at, 10, STAMP_DIGITS, &seconds) == 0u) || (**at != '.')) {
        return 0;
    }
    *at += 1;
    if ((number(at, 10, 6, &fraction) != 6u) || (**at != ')')) {
        return 0;
    }
    *at += 1;
    *time = (seconds * US_PER_S) + fraction;
    return 1;
}

static int read_data(const char *at, ods_frame_t *frame)
{
    uint64_t value;

    if (*at == 'R') {
        at++;
        frame->remote = 1;
        (void)number(&at, 10, 1, &value);
        frame->length = (uint8_t)value;
    } else {
        while ((frame->length < DATA_MAX) && (digit(*at, 16) >= 0)) {
            if (number(&at, 16, 2, &value) != 2u) {
                return 0;
            }
            frame->data[frame->length] = (uint8_t)value;
            frame->length++;
        }
    }
    return (frame->length <= DATA_MAX) && (is_blank(*at) || is_end(*at));
}

static candump_line_t read_frame(const char *at, ods_frame_t *frame)
{
    uint64_t id;
    const unsigned digits = number(&at, 16, LONG_ID_DIGITS, &id);

    if ((*at != '#') || ((digits != ID_DIGITS) && (digits != LONG_ID_DIGITS))) {
        return CANDUMP_WRONG;
    }
    at++;
    if ((digits == LONG_ID_DIGITS) || (*at == '#')) { /* ## is CAN FD */
        return CANDUMP_NO_FRAME;
    }
    memset(frame, 0, sizeof(*frame));
    frame->id = (uint16_t)id;
    return ((id <= ID_MAX) && read_data(at, frame)) ? CANDUMP_FRAME : CANDUMP_WRONG;
}

candump_line_t candump_read(const char *line, uint64_t *time, ods_frame_t *frame)
{
    const char *at = skip_blanks(line);

    if ((*at == '(') && !read_stamp(&at, time)) {
        return CANDUMP_WRONG;
    }
    at = skip_blanks(at);
    if (is_end(*at)) {
        return CANDUMP_NO_FRAME;
    }
    const char *const end = skip_word(at);
    if (memchr(at, '#', (size_t)(end - at)) == NULL) { /* the name of the bus */
        at = skip_blanks(end);
    }
    return read_frame(at, frame);
}

void candump_write(FILE *stream, uint64_t time, const ods_frame_t *frame)
{
    (void)fprintf(
        stream, "(%010" PRIu64 ".%06" PRIu64 ") can0 %03X#", time / US_PER_S, time % US_PER_S, (unsigned)frame->id);
    if (frame->remote != 0u) {
        (void)fprintf(stream, "R%u\n", (unsigned)frame->length);
        return;
    }
    for (uint32_t i = 0; i < frame->length; i++) {
        (void)fprintf(stream, "%02X", (unsigned)frame->data[i]);
    }
    (void)fputc('\n', stream);
}
