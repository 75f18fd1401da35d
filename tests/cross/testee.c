/*
 * One node of one device behind the line protocol of PROTOCOL.md: a program, and the functions testee_new, testee_answer
 * and testee_free of a shared library.
 *
 * It is compiled for a device by
 *     -DDEVICE_HEADER='"tmcm6212.h"' -DDEVICE_TYPE=tmcm6212_t -DDEVICE_INIT=tmcm6212_init
 * and includes condition_names.h, one line `[ODS_CONDITION_X] = "x",` for each condition, made from the vocabulary.
 */
#include <inttypes.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ods/node.h"
#include "ods_simulation.h"
#include DEVICE_HEADER

#define LINE_SIZE 250u
#define FIRST_ROOM 0x1000u
#define MAX_EVENT 64u
#define MAX_WORDS 40u
#define IMAGE_SIZE 0x10000u
#define MAX_VALUE 256u
#define MAX_STEP 0x40000000u
#define MAX_AXES 256u /* as many as a channel can name */
#define NO_OCTET 0xFFFFFFFFu
#define EVERY_OCTET 0xFFFFFFFEu

/* Why a line is not obeyed; NULL is no reason. */
typedef const char *nack_t;

static const char MALFORMED[] = "malformed";
static const char RANGE[] = "range";
static const char OFF[] = "off";
static const char ON[] = "on";

static const char *const CONDITION_NAMES[ODS_CONDITIONS] = {
#include "condition_names.h"
};

typedef enum {
    POWER_OFF, /* not yet */
    POWER_ON,
    POWER_CUT /* not any more */
} power_t;

/* An answer as it grows. */
typedef struct {
    char *text;
    size_t length;
    size_t room;
} answer_t;

typedef struct {
    DEVICE_TYPE drive;
    ods_port_t port;
    ods_config_t config;
    power_t power;
    uint32_t now; /* the end of this line */
    uint32_t begin; /* of this line */
    uint32_t told; /* the instant that the reader knows of */
    uint32_t image_size; /* octets that the device uses */
    uint32_t writes_left; /* until power is lost; 0: it is not */
    uint32_t dead; /* the octet of the memory that fails, or one of these: */
    uint8_t address;
    ods_os_status_t os_status;
    uint8_t os_reply[ODS_OS_COMMAND_SIZE];
    int tells_driver; /* what the driver of each axis is told */
    ods_simulation_t hardware[MAX_AXES]; /* of the axes */
    int broken; /* the runtime did what its port does not allow */
    answer_t answer;
    uint8_t image[IMAGE_SIZE];
} testee_t;

typedef struct {
    const char *word[MAX_WORDS];
    unsigned count;
} line_t;

testee_t *testee_new(unsigned node_id, uint32_t serial, uint32_t time);
const char *testee_answer(testee_t *testee, const char *line);
void testee_free(testee_t *testee);

/* ---- the answer -------------------------------------------------------------------------------------------------- */

/* Where the next `length` characters of the answer go, and one to end it. */
static char *room_for(answer_t *answer, size_t length)
{
    if (answer->length + length >= answer->room) {
        while (answer->length + length >= answer->room) {
            answer->room = (answer->room == 0u) ? FIRST_ROOM : answer->room * 2u;
        }
        answer->text = realloc(answer->text, answer->room);
        if (answer->text == NULL) {
            fputs("no memory for the answer\n", stderr);
            abort();
        }
    }
    return &answer->text[answer->length];
}

/* At most MAX_EVENT characters. */
static void say(testee_t *bench, const char *format, ...)
{
    char *const place = room_for(&bench->answer, MAX_EVENT);
    va_list arguments;

    va_start(arguments, format);
    bench->answer.length += (size_t)vsnprintf(place, MAX_EVENT + 1u, format, arguments);
    va_end(arguments);
}

static void say_octets(testee_t *bench, const uint8_t *octets, unsigned count)
{
    static const char digits[] = "0123456789ABCDEF";
    char *place = room_for(&bench->answer, ((size_t)count * 3u) + 1u);

    for (unsigned i = 0; i < count; i++) {
        *place++ = ' ';
        *place++ = digits[octets[i] >> 4];
        *place++ = digits[octets[i] & 0xFu];
    }
    *place = '\n';
    bench->answer.length += ((size_t)count * 3u) + 1u;
}

/* ---- what the device does ---------------------------------------------------------------------------------------- */

/* Ends this testee: the runtime asked for what there is not. */
static void broke(testee_t *bench, const char *what, uint32_t number)
{
    fprintf(stderr, "the runtime asks for %s %" PRIu32 "\n", what, number);
    bench->broken = 1;
}

/* Tells the instant where it is a new one. Returns 0 for a device without power, which reaches nobody. */
static int begin_event(testee_t *bench)
{
    const uint32_t now = bench->drive.node.now;

    if (bench->power != POWER_ON) {
        return 0;
    }
    if (now != bench->told) {
        say(bench, "AT %" PRIu32 "\n", now - bench->begin);
        bench->told = now;
    }
    return 1;
}

static void send_frame(void *context, const ods_frame_t *frame)
{
    testee_t *const bench = context;

    if (frame->remote != 0u) {
        broke(bench, "a remote frame with the CAN-ID", frame->id);
    }
    if (begin_event(bench)) {
        say(bench, "TX %03X", (unsigned)frame->id);
        say_octets(bench, frame->data, frame->length);
    }
}

static void say_output_of_axis(testee_t *bench, const char *name, uint8_t axis, uint32_t value)
{
    say(bench, "OUT axis%u.%s %" PRIu32 "\n", (unsigned)axis, name, value);
}

static void set_output(void *context, ods_output_t output, uint8_t channel, uint32_t value)
{
    testee_t *const bench = context;

    if (bench->power != POWER_ON) {
        return;
    }
    if (output >= ODS_OUTPUT_POWER) {
        ods_simulation_output(&bench->hardware[channel], output, value);
    }
    if ((output == ODS_OUTPUT_DRIVER) && !bench->tells_driver) {
        return;
    }
    (void)begin_event(bench);
    switch (output) {
    case ODS_OUTPUT_RUN_LED:
        say(bench, "OUT run_led %" PRIu32 "\n", value);
        break;
    case ODS_OUTPUT_ERROR_LED:
        say(bench, "OUT error_led %" PRIu32 "\n", value);
        break;
    case ODS_OUTPUT_DIGITAL:
        say(bench, "OUT digital %" PRIu32 "\n", value);
        break;
    case ODS_OUTPUT_ANALOG:
        say(bench, "OUT analog%u %d\n", (unsigned)channel, (int)(int16_t)value);
        break;
    case ODS_OUTPUT_POWER:
        say_output_of_axis(bench, "power", channel, value);
        break;
    case ODS_OUTPUT_BRAKE:
        say_output_of_axis(bench, "brake", channel, value);
        break;
    case ODS_OUTPUT_CURRENT:
        say_output_of_axis(bench, "current", channel, value);
        break;
    case ODS_OUTPUT_DRIVER:
        say_output_of_axis(bench, "driver", channel, value);
        break;
    case ODS_OUTPUTS:
    default:
        broke(bench, "output", (uint32_t)output);
        break;
    }
}

static void join_bus(void *context, uint16_t bit_rate, uint8_t node_id)
{
    testee_t *const bench = context;

    if (begin_event(bench)) {
        say(bench, "BUS %u %u\n", (unsigned)bit_rate, (unsigned)node_id);
    }
}

static void set_motor(void *context, uint8_t axis, uint16_t parameter, int32_t value)
{
    testee_t *const bench = context;

    if (bench->tells_driver && begin_event(bench)) {
        say(bench, "OUT axis%u.parameter %04X %" PRId32 "\n", (unsigned)axis, (unsigned)parameter, value);
    }
}

static void drive_motor(void *context, uint8_t axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer)
{
    testee_t *const bench = context;

    if (bench->power == POWER_ON) {
        ods_simulation_motor(&bench->hardware[axis], demand, answer);
    }
}

static ods_os_status_t run_os_command(
    void *context, const uint8_t command[ODS_OS_COMMAND_SIZE], uint8_t reply[ODS_OS_COMMAND_SIZE])
{
    testee_t *const bench = context;

    if (begin_event(bench)) {
        say(bench, "OS");
        say_octets(bench, command, ODS_OS_COMMAND_SIZE);
    }
    memcpy(reply, bench->os_reply, ODS_OS_COMMAND_SIZE);
    return bench->os_status;
}

/* An octet of the image. What lies outside of what the device says it uses is a bug of the runtime. */
static uint8_t *image_at(testee_t *bench, uint32_t address)
{
    if (address >= bench->image_size) {
        broke(bench, "address", address);
        address = 0;
    }
    return &bench->image[address];
}

static int fails_at(const testee_t *bench, uint32_t address)
{
    return (bench->dead == EVERY_OCTET) || (bench->dead == address);
}

static int read_memory(void *context, uint32_t address, uint8_t *octet)
{
    testee_t *const bench = context;

    *octet = *image_at(bench, address);
    return fails_at(bench, address);
}

static int write_memory(void *context, uint32_t address, uint8_t octet)
{
    testee_t *const bench = context;
    uint8_t *const place = image_at(bench, address);

    if (fails_at(bench, address)) {
        return 1;
    }
    if (bench->writes_left != 0u) {
        bench->writes_left--;
        if (bench->writes_left == 0u) {
            bench->power = POWER_CUT;
        }
    }
    if (bench->power == POWER_ON) {
        *place = octet;
    }
    return 0;
}

/* ---- words ------------------------------------------------------------------------------------------------------- */

static int is_word(const line_t *line, unsigned at, const char *word)
{
    return (at < line->count) && (strcmp(line->word[at], word) == 0);
}

static int hex_digit(char c)
{
    const char *const digits = "0123456789ABCDEFabcdef";
    const char *const found = (c == '\0') ? NULL : strchr(digits, c);

    if (found == NULL) {
        return -1;
    }
    return (int)(found - digits) - ((found - digits > 15) ? 6 : 0);
}

/* Each reader returns 0 where the word is not a number of its kind. */
static int read_hex(const char *word, unsigned min_digits, unsigned max_digits, uint32_t *value)
{
    const size_t length = strlen(word);

    *value = 0;
    if ((length < min_digits) || (length > max_digits)) {
        return 0;
    }
    for (; *word != '\0'; word++) {
        const int digit = hex_digit(*word);
        if (digit < 0) {
            return 0;
        }
        *value = (*value << 4) | (uint32_t)digit;
    }
    return 1;
}

static int read_decimal(const char *word, unsigned max_digits, uint64_t *value)
{
    const size_t length = strlen(word);

    *value = 0;
    if ((length == 0u) || (length > max_digits)) {
        return 0;
    }
    for (; *word != '\0'; word++) {
        if ((*word < '0') || (*word > '9')) {
            return 0;
        }
        *value = (*value * 10u) + (uint64_t)(*word - '0');
    }
    return 1;
}

/* A number that may have a sign. */
static int read_signed(const char *word, unsigned max_digits, int64_t *value)
{
    const int negative = (word[0] == '-');
    uint64_t amount;

    *value = 0;
    if (!read_decimal(negative ? word + 1 : word, max_digits, &amount)) {
        return 0;
    }
    *value = negative ? -(int64_t)amount : (int64_t)amount;
    return 1;
}

/* The octets from word `at` to the end of the line. */
static int read_octets(const line_t *line, unsigned at, unsigned max, uint8_t *octets)
{
    if (line->count - at > max) {
        return 0;
    }
    for (unsigned i = at; i < line->count; i++) {
        uint32_t octet;
        if (!read_hex(line->word[i], 2, 2, &octet)) {
            return 0;
        }
        octets[i - at] = (uint8_t)octet;
    }
    return 1;
}

static int is_name(const char *word)
{
    return (word[0] != '\0') && (strspn(word, "abcdefghijklmnopqrstuvwxyz0123456789_.") == strlen(word));
}

/* ---- lines ------------------------------------------------------------------------------------------------------- */

/* The reason not to hand an event to a device without power: it is off, or nothing happens. */
static nack_t without_power(const testee_t *bench)
{
    return (bench->power == POWER_OFF) ? OFF : NULL;
}

static nack_t do_rx(testee_t *bench, const line_t *line)
{
    ods_frame_t frame = { 0, 0, 0, { 0 } };
    uint32_t id;
    uint64_t length = 0;

    if ((line->count < 2u) || !read_hex(line->word[1], 1, 3, &id)) {
        return MALFORMED;
    }
    if (is_word(line, 2, "R")) {
        if ((line->count > 4u) || ((line->count == 4u) && !read_decimal(line->word[3], 1, &length))) {
            return MALFORMED;
        }
        frame.remote = 1;
    } else {
        if (!read_octets(line, 2, 8, frame.data)) {
            return MALFORMED;
        }
        length = line->count - 2u;
    }
    if ((id > 0x7FFu) || (length > 8u)) {
        return RANGE;
    }
    if (bench->power != POWER_ON) {
        return without_power(bench);
    }
    frame.id = (uint16_t)id;
    frame.length = (uint8_t)length;
    ods_node_receive(&bench->drive.node, bench->now, &frame);
    return NULL;
}

static nack_t do_time(testee_t *bench, const line_t *line)
{
    uint64_t step;

    if ((line->count != 2u) || !read_decimal(line->word[1], 10, &step)) {
        return MALFORMED;
    }
    if (step > MAX_STEP) {
        return RANGE;
    }
    bench->now += (uint32_t)step;
    if (bench->power == POWER_ON) {
        ods_node_advance(&bench->drive.node, bench->now);
    }
    return NULL;
}

/* Returns 0 if the device has no such input. */
static int find_input(const testee_t *bench, const char *name, ods_input_t *input, uint8_t *channel, int64_t *max)
{
    uint64_t number;

    *channel = 0;
    *max = UINT32_MAX;
    if (strcmp(name, "address") == 0) {
        *input = ODS_INPUT_ADDRESS;
        *max = 255;
    } else if (strcmp(name, "enable") == 0) {
        *input = ODS_INPUT_ENABLE;
        *max = 1;
    } else if (strcmp(name, "digital") == 0) {
        *input = ODS_INPUT_DIGITAL;
    } else if ((strncmp(name, "analog", 6) == 0) && read_decimal(name + 6, 1, &number)) {
        *input = ODS_INPUT_ANALOG;
        *channel = (uint8_t)number;
        return number < bench->drive.node.device->analog_inputs;
    } else {
        return 0;
    }
    return 1;
}

/* The axis of `axisN.NAME`, and the name. Returns NULL if it is nothing of the kind, or the device has no such axis. */
static const char *find_axis(const testee_t *bench, const char *name, uint8_t *axis)
{
    char digits[LINE_SIZE + 1u] = "";
    const char *const dot = strchr(name, '.');
    uint64_t number;

    if ((dot == NULL) || (strncmp(name, "axis", 4) != 0)) {
        return NULL;
    }
    memcpy(digits, name + 4, (size_t)(dot - name) - 4u);
    if (!read_decimal(digits, 10, &number) || (number >= bench->drive.node.device->axes)) {
        return NULL;
    }
    *axis = (uint8_t)number;
    return dot + 1;
}

/* Returns 0 if the value is out of the range of the input. */
static int set_hardware(testee_t *bench, uint8_t axis, ods_simulation_input_t input, int64_t value)
{
    if ((value < INT32_MIN) || (value > INT32_MAX) ||
        !ods_simulation_set(&bench->hardware[axis], input, (int32_t)value)) {
        return 0;
    }
    if (bench->power == POWER_ON) {
        ods_node_motor(&bench->drive.node, bench->now, axis, &bench->hardware[axis].answer);
    }
    return 1;
}

/* An input of the simulated hardware. It goes beyond the device, and so does its range. */
static nack_t do_hardware(testee_t *bench, const char *name, int64_t value)
{
    const uint8_t axes = bench->drive.node.device->axes;
    uint8_t axis = 0;
    const char *const of_axis = find_axis(bench, name, &axis);

    if (of_axis != NULL) {
        const ods_simulation_input_t input = ods_simulation_find(of_axis);
        return ((input < ODS_SIMULATION_AXIS_INPUTS) && set_hardware(bench, axis, input, value)) ? NULL : RANGE;
    }
    if ((strcmp(name, "supply") != 0) || (axes == 0u)) {
        return RANGE;
    }
    for (axis = 0; axis < axes; axis++) {
        if (!set_hardware(bench, axis, ODS_SIMULATION_SUPPLY, value)) {
            return RANGE;
        }
    }
    return NULL;
}

static nack_t do_input(testee_t *bench, const line_t *line)
{
    ods_input_t input;
    uint8_t channel;
    int64_t value;
    int64_t max;

    if ((line->count != 3u) || !is_name(line->word[1]) || !read_signed(line->word[2], 10, &value)) {
        return MALFORMED;
    }
    if (!find_input(bench, line->word[1], &input, &channel, &max)) {
        return do_hardware(bench, line->word[1], value);
    }
    if ((value < 0) || (value > max)) {
        return RANGE;
    }
    if (input == ODS_INPUT_ADDRESS) {
        bench->address = (uint8_t)value;
    } else if (bench->power != POWER_ON) {
        return without_power(bench);
    }
    if (bench->power == POWER_ON) {
        ods_node_input(&bench->drive.node, bench->now, input, channel, (uint32_t)value);
    }
    return NULL;
}

static nack_t do_fault(testee_t *bench, const line_t *line)
{
    const int on = is_word(line, 3, "on");
    uint64_t axis;
    unsigned condition = 0;

    if ((line->count != 4u) || (strncmp(line->word[1], "axis", 4) != 0) ||
        !read_decimal(line->word[1] + 4, 10, &axis) || !is_name(line->word[2]) || (!on && !is_word(line, 3, "off"))) {
        return MALFORMED;
    }
    while ((condition < ODS_AXIS_CONDITIONS) && (strcmp(CONDITION_NAMES[condition], line->word[2]) != 0)) {
        condition++;
    }
    if ((axis >= bench->drive.node.device->axes) || (condition == ODS_AXIS_CONDITIONS)) {
        return RANGE;
    }
    if (bench->power != POWER_ON) {
        return without_power(bench);
    }
    ods_node_fault(&bench->drive.node, bench->now, (uint8_t)axis, (ods_condition_t)condition, on);
    return NULL;
}

static nack_t do_can(testee_t *bench, const line_t *line)
{
    static const struct {
        const char *word;
        ods_can_t event;
    } events[] = {
        { "ok", ODS_CAN_OK },
        { "warning", ODS_CAN_WARNING },
        { "passive", ODS_CAN_PASSIVE },
        { "busoff", ODS_CAN_BUS_OFF },
        { "error", ODS_CAN_ERROR },
        { "overrun", ODS_CAN_OVERRUN },
        { "rxfull", ODS_CAN_RX_FULL },
        { "txfull", ODS_CAN_TX_FULL },
    };

    for (unsigned i = 0; i < sizeof(events) / sizeof(events[0]); i++) {
        if ((line->count == 2u) && is_word(line, 1, events[i].word)) {
            if (bench->power != POWER_ON) {
                return without_power(bench);
            }
            ods_node_can(&bench->drive.node, bench->now, events[i].event);
            return NULL;
        }
    }
    return MALFORMED;
}

static void tell_image(testee_t *bench)
{
    for (uint32_t address = 0; address < bench->image_size; address += 32u) {
        const uint32_t left = bench->image_size - address;
        say(bench, "NVM %04" PRIX32, address);
        say_octets(bench, &bench->image[address], (left < 32u) ? left : 32u);
    }
}

static nack_t do_memory(testee_t *bench, const line_t *line)
{
    uint8_t octets[32];
    uint32_t address;

    if (line->count == 1u) {
        tell_image(bench);
    } else if ((line->count == 2u) && (is_word(line, 1, "ok") || is_word(line, 1, "fail"))) {
        bench->dead = is_word(line, 1, "fail") ? EVERY_OCTET : NO_OCTET;
    } else if (is_word(line, 1, "fail")) {
        if ((line->count != 3u) || !read_hex(line->word[2], 1, 4, &address)) {
            return MALFORMED;
        }
        if (address >= bench->image_size) {
            return RANGE;
        }
        bench->dead = address;
    } else if (is_word(line, 1, "set")) {
        if ((line->count < 4u) || !read_hex(line->word[2], 1, 4, &address) || !read_octets(line, 3, 32, octets)) {
            return MALFORMED;
        }
        if (address + line->count - 3u > bench->image_size) {
            return RANGE;
        }
        memcpy(&bench->image[address], octets, line->count - 3u);
    } else {
        return MALFORMED;
    }
    return NULL;
}

static nack_t do_os(testee_t *bench, const line_t *line)
{
    uint8_t reply[ODS_OS_COMMAND_SIZE] = { 0 };
    uint64_t status;

    if ((line->count == 2u) && is_word(line, 1, "none")) {
        bench->port.os_command = NULL;
        return NULL;
    }
    if ((line->count < 2u) || !read_decimal(line->word[1], 1, &status) ||
        !read_octets(line, 2, ODS_OS_COMMAND_SIZE, reply)) {
        return MALFORMED;
    }
    if (status > (uint64_t)ODS_OS_FAILED_WITH_REPLY) {
        return RANGE;
    }
    bench->os_status = (ods_os_status_t)status;
    memcpy(bench->os_reply, reply, sizeof(reply));
    bench->port.os_command = run_os_command;
    return NULL;
}

static nack_t do_tell(testee_t *bench, const line_t *line)
{
    const int on = is_word(line, 2, "on");

    if ((line->count != 3u) || !is_word(line, 1, "driver") || (!on && !is_word(line, 2, "off"))) {
        return MALFORMED;
    }
    bench->tells_driver = on;
    return NULL;
}

/* Memory of a node that has just been powered holds anything. */
static void make_node(testee_t *bench)
{
    memset(&bench->drive, 0xA5, sizeof(bench->drive));
    DEVICE_INIT(&bench->drive, &bench->port, &bench->config);
}

static nack_t do_power(testee_t *bench, const line_t *line)
{
    uint64_t writes = 0;

    if ((line->count == 2u) && is_word(line, 1, "on")) {
        if (bench->power == POWER_ON) {
            return ON;
        }
        make_node(bench);
        bench->power = POWER_ON;
        bench->writes_left = 0;
        ods_node_input(&bench->drive.node, bench->now, ODS_INPUT_ADDRESS, 0, bench->address);
        for (uint8_t axis = 0; axis < bench->drive.node.device->axes; axis++) {
            ods_simulation_power_on(&bench->hardware[axis]);
            ods_node_motor(&bench->drive.node, bench->now, axis, &bench->hardware[axis].answer);
        }
        ods_node_power_on(&bench->drive.node, bench->now);
        return NULL;
    }
    if (!is_word(line, 1, "cut") || (line->count > 3u) ||
        ((line->count == 3u) && !read_decimal(line->word[2], 10, &writes))) {
        return MALFORMED;
    }
    if ((line->count == 3u) && ((writes == 0u) || (writes > UINT32_MAX))) {
        return RANGE;
    }
    if (bench->power != POWER_ON) {
        return without_power(bench);
    }
    bench->writes_left = (uint32_t)writes;
    if (line->count == 2u) {
        bench->power = POWER_CUT;
    }
    return NULL;
}

static void tell_entry(testee_t *bench, uint16_t index, uint8_t sub, uint32_t *abort_code)
{
    uint8_t value[MAX_VALUE];
    uint16_t length = 0;

    *abort_code = ods_node_read(&bench->drive.node, index, sub, value, sizeof(value), &length);
    if ((*abort_code == ODS_ABORT_NO_OBJECT) || (*abort_code == ODS_ABORT_NO_SUB_INDEX)) {
        return;
    }
    say(bench, "OD %04X:%02X", (unsigned)index, (unsigned)sub);
    if (*abort_code != 0u) {
        say(bench, " ABORT %08" PRIX32 "\n", *abort_code);
    } else {
        say_octets(bench, value, length);
    }
}

static nack_t do_dump(testee_t *bench, const line_t *line)
{
    uint32_t limits[2];

    if ((line->count != 2u) || (strlen(line->word[1]) != 9u) || (line->word[1][4] != '-')) {
        return MALFORMED;
    }
    for (unsigned i = 0; i < 2u; i++) {
        char digits[5] = { 0 };
        memcpy(digits, &line->word[1][i * 5u], 4);
        if (!read_hex(digits, 4, 4, &limits[i])) {
            return MALFORMED;
        }
    }
    if (limits[0] > limits[1]) {
        return RANGE;
    }
    if (bench->power != POWER_ON) {
        return without_power(bench);
    }
    for (uint32_t index = limits[0]; index <= limits[1]; index++) {
        uint32_t abort_code = 0;
        for (unsigned sub = 0; (sub < 256u) && (abort_code != ODS_ABORT_NO_OBJECT); sub++) {
            tell_entry(bench, (uint16_t)index, (uint8_t)sub, &abort_code);
        }
    }
    return NULL;
}

static nack_t obey(testee_t *bench, const line_t *line)
{
    static const struct {
        const char *word;
        nack_t (*handler)(testee_t *bench, const line_t *line);
    } handlers[] = {
        { "RX", do_rx },
        { "T", do_time },
        { "IN", do_input },
        { "FAULT", do_fault },
        { "CAN", do_can },
        { "NVM", do_memory },
        { "OS", do_os },
        { "TELL", do_tell },
        { "POWER", do_power },
        { "DUMP", do_dump },
    };

    for (unsigned i = 0; i < sizeof(handlers) / sizeof(handlers[0]); i++) {
        if (is_word(line, 0, handlers[i].word)) {
            return handlers[i].handler(bench, line);
        }
    }
    return MALFORMED;
}

/* Cut a text at each space. Too many words become an empty line, which is malformed. */
static void split(char *text, line_t *line)
{
    line->count = 0;
    while (text != NULL) {
        char *const space = strchr(text, ' ');
        if (line->count == MAX_WORDS) {
            line->count = 0;
            return;
        }
        line->word[line->count] = text;
        line->count++;
        if (space != NULL) {
            *space = '\0';
        }
        text = (space == NULL) ? NULL : space + 1;
    }
}

/* ---- the library ------------------------------------------------------------------------------------------------- */

/* A testee without power. Returns NULL if there is no memory for it or for its image. */
testee_t *testee_new(unsigned node_id, uint32_t serial, uint32_t time)
{
    testee_t *const bench = calloc(1, sizeof(*bench));

    if (bench == NULL) {
        return NULL;
    }
    bench->config.node_id = (uint8_t)node_id;
    bench->config.serial_number = serial;
    bench->now = time;
    bench->dead = NO_OCTET;
    bench->port.context = bench;
    bench->port.send = send_frame;
    bench->port.output = set_output;
    bench->port.bus = join_bus;
    bench->port.nvm_read = read_memory;
    bench->port.nvm_write = write_memory;
    bench->port.motor_set = set_motor;
    bench->port.motor = drive_motor;
    memset(bench->image, 0xFF, sizeof(bench->image));
    make_node(bench);
    for (uint8_t axis = 0; axis < bench->drive.node.device->axes; axis++) {
        ods_simulation_init(&bench->hardware[axis]);
    }
    bench->image_size = ods_store_size(bench->drive.node.device);
    if (bench->image_size > IMAGE_SIZE) {
        testee_free(bench);
        return NULL;
    }
    return bench;
}

/* The answer to a line without its end, valid until the next call. NULL once the runtime is broken. */
const char *testee_answer(testee_t *bench, const char *line)
{
    char text[LINE_SIZE + 1u] = "";
    line_t words;
    nack_t nack;
    uint32_t next;

    if (strlen(line) <= LINE_SIZE) {
        memcpy(text, line, strlen(line) + 1u);
    }
    split(text, &words);
    bench->answer.length = 0;
    bench->begin = bench->now;
    bench->told = bench->now;
    nack = obey(bench, &words);
    if (nack != NULL) {
        say(bench, "NACK %s\n", nack);
    } else if ((bench->power == POWER_ON) && ods_node_next(&bench->drive.node, &next)) {
        say(bench, "NEXT %" PRIu32 "\n", next - bench->now);
    } else {
        say(bench, "NEXT -\n");
    }
    bench->answer.text[bench->answer.length] = '\0';
    return bench->broken ? NULL : bench->answer.text;
}

void testee_free(testee_t *bench)
{
    if (bench != NULL) {
        free(bench->answer.text);
        free(bench);
    }
}

/* ---- the program ------------------------------------------------------------------------------------------------- */

/* Reads a line without its end. One that is too long stays so, one with a NUL in it becomes an empty one. 0: the end. */
static int read_line(char text[LINE_SIZE + 2u])
{
    unsigned length = 0;
    int bad = 0;
    int c = getchar();

    if (c == EOF) {
        return 0;
    }
    for (; (c != EOF) && (c != '\n'); c = getchar()) {
        if (c == '\0') {
            bad = 1;
        } else if (length <= LINE_SIZE) {
            text[length] = (char)c;
            length++;
        }
    }
    text[bad ? 0u : length] = '\0';
    return 1;
}

typedef struct {
    uint64_t node_id;
    uint64_t serial;
    uint32_t time;
} options_t;

static int read_options(options_t *options, int argc, char **argv)
{
    for (int i = 1; i < argc; i += 2) {
        const char *const value = (i + 1 < argc) ? argv[i + 1] : "";
        int good = 0;

        if (strcmp(argv[i], "--node-id") == 0) {
            good = read_decimal(value, 10, &options->node_id) && (options->node_id <= 127u);
        } else if (strcmp(argv[i], "--serial") == 0) {
            good = read_decimal(value, 10, &options->serial) && (options->serial <= UINT32_MAX);
        } else if (strcmp(argv[i], "--time") == 0) {
            good = read_hex(value, 1, 8, &options->time);
        }
        if (!good) {
            fprintf(stderr, "usage: testee [--node-id N] [--serial N] [--time HEX], not %s %s\n", argv[i], value);
            return 0;
        }
    }
    return 1;
}

int main(int argc, char **argv)
{
    options_t options = { 0, 0, 0 };
    char line[LINE_SIZE + 2u];
    const char *text = "";
    testee_t *testee;

    if (!read_options(&options, argc, argv)) {
        return 2;
    }
    testee = testee_new((unsigned)options.node_id, (uint32_t)options.serial, options.time);
    if (testee == NULL) {
        fputs("no memory, or the image is too small\n", stderr);
        return 2;
    }
    while ((text != NULL) && read_line(line)) {
        text = testee_answer(testee, line);
        if (text != NULL) {
            fputs(text, stdout);
            fflush(stdout);
        }
    }
    testee_free(testee);
    return (text == NULL) ? 1 : 0;
}
