#include "ods_homing.h"

#include "ods_motion.h"
#include "ods_ramp.h"
#include "ods_units.h"

#define START 0x0010u /* bit 4 of the controlword */
#define REACHED 0x0400u /* bits of the statusword */
#define ATTAINED 0x1000u

typedef enum {
    IDLE,
    SEARCH, /* fast, until the switch is active */
    BRAKE, /* the switch was found on a way that does not lead over its edge */
    EDGE, /* slowly over the edge */
    BACK, /* the edge was passed too fast: slowly back onto the switch */
    INDEX, /* slowly to the next index pulse */
    STOP /* called off by bit 4 */
} phase_t;

static const uint8_t lines[] = {
    [ODS_SWITCH_NONE] = 0,
    [ODS_SWITCH_NEGATIVE_LIMIT] = ODS_LINE_LEFT,
    [ODS_SWITCH_POSITIVE_LIMIT] = ODS_LINE_RIGHT,
    [ODS_SWITCH_HOME] = ODS_LINE_HOME,
};

static void go_on(ods_axis_t *axis, phase_t phase)
{
    axis->homing.phase = (uint8_t)phase;
}

static int is_active(const ods_axis_t *axis, const ods_homing_row_t *method)
{
    return (axis->values->digital_inputs & lines[method->reference]) != 0u;
}

void ods_homing_forget(ods_axis_t *axis)
{
    go_on(axis, IDLE);
    axis->homing.status = 0;
}

/* ---- the end ----------------------------------------------------------------------------------------------------- */

static void found(ods_axis_t *axis, int32_t position)
{
    ods_motion_set_position(axis, position);
    axis->values->home_offset_display = axis->values->home_offset;
    go_on(axis, IDLE);
    axis->homing.status = REACHED | ATTAINED;
}

/* The position at the switch. */
static int32_t home(const ods_axis_t *axis)
{
    return (int32_t)(0u - (uint32_t)axis->values->home_offset);
}

/* Stopped without a home position: a homing that failed looks the same (manual, section 8.2.2). */
static void end(ods_axis_t *axis)
{
    go_on(axis, IDLE);
    axis->homing.status = REACHED;
}

/* ---- events ------------------------------------------------------------------------------------------------------ */

void ods_homing_enabled(ods_axis_t *axis)
{
    go_on(axis, IDLE);
}

void ods_homing_control(ods_axis_t *axis, uint32_t word, uint32_t before)
{
    if ((word & START) == 0u) {
        axis->flags &= ~ODS_AXIS_CALLED;
        if (ods_homing_runs(axis)) {
            go_on(axis, STOP);
        }
    } else if ((before & START) == 0u) {
        axis->flags |= ODS_AXIS_CALLED;
    }
}

static const ods_homing_row_t *find(const ods_node_t *node, int8_t number)
{
    for (uint32_t n = 0; n < node->device->homing_count; n++) {
        if (node->device->homing_methods[n].method == number) {
            return &node->device->homing_methods[n];
        }
    }
    return NULL;
}

static void start(ods_axis_t *axis, const ods_homing_row_t *method)
{
    axis->homing.method = method;
    axis->homing.direction = method->direction;
    axis->homing.has_reversed = 0;
    axis->homing.was_active = 0;
    axis->homing.status = 0;
    if (method->reference == (uint8_t)ODS_SWITCH_NONE) {
        go_on(axis, INDEX);
    } else {
        go_on(axis, is_active(axis, method) ? EDGE : SEARCH);
    }
}

void ods_homing_begin(const ods_node_t *node, ods_axis_t *axis, int is_enabled)
{
    if ((axis->flags & ODS_AXIS_CALLED) == 0u) {
        return;
    }
    const ods_homing_row_t *const method = find(node, axis->values->homing_method);
    if ((method == NULL) || (((method->flags & ODS_HOMING_POWER) != 0u) && !is_enabled)) {
        return;
    }
    if ((method->reference != (uint8_t)ODS_SWITCH_NONE) || ((method->flags & ODS_HOMING_INDEX_PULSE) != 0u)) {
        start(axis, method);
    } else if (method->method != 0) {
        found(axis, 0);
    }
}

/* ---- a tick ------------------------------------------------------------------------------------------------------ */

/* The direction that the phase leads to. */
static int64_t heading(const ods_axis_t *axis)
{
    switch (axis->homing.phase) {
    case SEARCH:
        return axis->homing.direction;
    case BACK:
        return -axis->homing.method->edge;
    default:
        return axis->homing.method->edge;
    }
}

/* Whether the axis still moves the way that leads away from where its phase does. */
static int is_turning(const ods_axis_t *axis, int64_t velocity)
{
    return (velocity != 0) && ((velocity < 0) == (heading(axis) > 0));
}

static int is_slow(const ods_axis_t *axis, int64_t velocity)
{
    const int64_t slow = ods_velocity(axis->values, axis->values->homing_speeds_slow);
    return (velocity <= slow) && (velocity >= -slow);
}

/* The edge. It counts if the axis was slow. */
static void pass(ods_axis_t *axis, int64_t velocity)
{
    if (!is_slow(axis, velocity)) {
        go_on(axis, BACK);
    } else if ((axis->homing.method->flags & ODS_HOMING_INDEX_PULSE) != 0u) {
        go_on(axis, INDEX);
    } else {
        found(axis, home(axis));
    }
}

/* A limit switch ahead turns the search round, or it ends the homing. */
static void mind_limits(ods_axis_t *axis, int64_t velocity)
{
    const ods_homing_row_t *const method = axis->homing.method;
    const int64_t way = (velocity != 0) ? velocity : heading(axis);
    const uint32_t ahead = (way < 0) ? ODS_LINE_LEFT : ODS_LINE_RIGHT;
    /* Still on the way that it is just turning away from. */
    const uint8_t phase = axis->homing.phase;
    const int leaves = ((phase == (uint8_t)SEARCH) || (phase == (uint8_t)EDGE)) && is_turning(axis, velocity);

    if ((axis->values->digital_inputs & ahead) == 0u) {
        return;
    }
    if ((axis->homing.phase == (uint8_t)SEARCH) && (axis->homing.has_reversed == 0u) &&
        (ahead == lines[method->reverse_at])) {
        axis->homing.direction = (int8_t)-axis->homing.direction;
        axis->homing.has_reversed = 1;
    } else if ((ahead != lines[method->reference]) && !leaves) {
        end(axis);
    }
}

/* What the switches say to the phase. */
static void look(ods_axis_t *axis, int64_t velocity)
{
    const ods_homing_row_t *const method = axis->homing.method;
    const int active = is_active(axis, method);

    if ((axis->homing.phase == (uint8_t)SEARCH) && active) {
        go_on(axis, (axis->homing.direction == method->edge) ? EDGE : BRAKE);
    }
    const int turns = is_turning(axis, velocity);
    switch (axis->homing.phase) {
    case EDGE:
        if (turns) {
            break;
        }
        if (active) {
            axis->homing.was_active = 1;
        } else if (axis->homing.was_active != 0u) {
            pass(axis, velocity);
        }
        break;
    case BACK:
        if (active) {
            go_on(axis, BRAKE);
        }
        break;
    case INDEX:
        if ((axis->encoder.has_pulse != 0u) && !turns && is_slow(axis, velocity)) {
            found(axis, home(axis));
        }
        break;
    default:
        break;
    }
    switch (axis->homing.phase) {
    case SEARCH:
    case EDGE:
    case BACK:
    case INDEX:
        mind_limits(axis, velocity);
        break;
    default:
        break;
    }
}

/* Stopped: the edge comes next, or nothing. */
static void rest(ods_axis_t *axis)
{
    if (axis->homing.phase == (uint8_t)STOP) {
        end(axis);
    } else {
        go_on(axis, EDGE);
        axis->homing.was_active = 0;
    }
}

int64_t ods_homing_step(ods_axis_t *axis, int64_t velocity)
{
    const ods_axis_values_t *const values = axis->values;
    const int64_t acceleration = ods_acceleration(values, values->homing_acceleration);

    look(axis, velocity);
    switch (axis->homing.phase) {
    case IDLE:
        return 0;
    case BRAKE:
    case STOP: {
        const int64_t slower = ods_ramp_slow_down(velocity, acceleration);
        if (slower == 0) {
            rest(axis);
        }
        return slower;
    }
    default: {
        const uint32_t speed =
            (axis->homing.phase == (uint8_t)SEARCH) ? values->homing_speeds_fast : values->homing_speeds_slow;
        return ods_ramp_turn(velocity, heading(axis) * ods_velocity(values, speed), acceleration, 0, 0);
    }
    }
}
