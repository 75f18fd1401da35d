/*
 * The run LED and the error LED (CiA 303-3). For each, the row of highest priority whose reason holds shows; a row that
 * goes on to show is not started anew.
 */
#ifndef ODS_LED_H
#define ODS_LED_H

#include "ods/node.h"

/* Choose the patterns, step them, and tell the port the LEDs that have changed; at power-on all of them. */
void ods_led_put(ods_node_t *node, int all);

/* Whether a phase ends now. */
int ods_led_is_due(const ods_node_t *node);

#endif
