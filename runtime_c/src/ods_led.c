#include "ods_led.h"

#include "ods_core.h"

static int holds(const ods_node_t *node, uint8_t when)
{
    switch (when) {
    case ODS_LED_WHEN_STOPPED:
        return node->state == (uint8_t)ODS_NMT_STATE_STOPPED;
    case ODS_LED_WHEN_PRE_OPERATIONAL:
        return node->state == (uint8_t)ODS_NMT_STATE_PRE_OPERATIONAL;
    case ODS_LED_WHEN_OPERATIONAL:
        return node->state == (uint8_t)ODS_NMT_STATE_OPERATIONAL;
    case ODS_LED_WHEN_CAN_WARNING:
        return node->can >= (uint8_t)ODS_CAN_WARNING;
    case ODS_LED_WHEN_HEARTBEAT_LOST:
        return node->heartbeat.lost != 0u;
    case ODS_LED_WHEN_BUS_OFF:
        return node->can == (uint8_t)ODS_CAN_BUS_OFF;
    default:
        return when == (uint8_t)ODS_LED_WHEN_NO_ERROR;
    }
}

/* The row that shows; ODS_NONE leaves the LED dark. */
static uint8_t choose(const ods_node_t *node, uint32_t led)
{
    uint8_t chosen = ODS_NONE;
    for (uint8_t n = 0; n < node->device->led_count; n++) {
        const ods_led_row_t *const row = &node->device->leds[n];
        if ((row->led == led) && holds(node, row->when) &&
            ((chosen == ODS_NONE) || (row->priority > node->device->leds[chosen].priority))) {
            chosen = n;
        }
    }
    return chosen;
}

/* Show a phase of a pattern, counted from when the last one ended. */
static void begin_phase(ods_node_t *node, uint32_t led, uint8_t phase, uint32_t from)
{
    ods_led_state_t *const state = &node->leds[led];
    const ods_led_row_t *const row = &node->device->leds[state->row];
    state->phase = phase;
    state->on = (phase % 2u == 0u);
    ods_timer_start(
        node,
        ODS_TIMER_RUN_LED + led,
        from + (node->device->led_phases[row->first + phase] * ODS_US_PER_MS));
}

static void show(ods_node_t *node, uint32_t led, uint8_t chosen)
{
    ods_led_state_t *const state = &node->leds[led];
    const uint32_t timer = ODS_TIMER_RUN_LED + led;
    if (chosen != state->row) {
        state->row = chosen;
        ods_timer_stop(node, timer);
        state->on = (chosen != ODS_NONE) && (node->device->leds[chosen].steady != 0u);
        if ((chosen != ODS_NONE) && (node->device->leds[chosen].phases != 0u)) {
            begin_phase(node, led, 0, node->now);
        }
    } else if (ods_timer_due(node, timer)) {
        const uint32_t next = (state->phase + 1u) % node->device->leds[chosen].phases;
        begin_phase(node, led, (uint8_t)next, node->deadlines[timer]);
    } /* else it goes on */
}

void ods_led_put(ods_node_t *node, int all)
{
    for (uint32_t led = 0; led < (uint32_t)ODS_LEDS; led++) {
        const uint8_t was_on = node->leds[led].on;
        show(node, led, choose(node, led));
        if ((all || (was_on != node->leds[led].on)) && (node->port->output != NULL)) {
            node->port->output(node->port->context, (ods_output_t)led, 0, node->leds[led].on);
        }
    }
}

int ods_led_is_due(const ods_node_t *node)
{
    return ods_timer_due(node, ODS_TIMER_RUN_LED) || ods_timer_due(node, ODS_TIMER_ERROR_LED);
}
