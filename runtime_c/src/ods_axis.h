/*
 * An axis as the rest of the node sees it. What moves it stands behind these functions; until the motion modules fill
 * them, an axis rests in SWITCH ON DISABLED.
 */
#ifndef ODS_AXIS_H
#define ODS_AXIS_H

#include "ods/node.h"

/* As at power-on. The values of the axis have just been set. */
void ods_axis_reset(ods_node_t *node, uint8_t axis);

/* A value with an effect of axes was written. The instance is that of an axis if the device has axes. */
void ods_axis_written(ods_node_t *node, uint32_t instance, uint32_t effect);

/* What an emergency does to the axis (ods_reaction_t). */
void ods_axis_react(ods_node_t *node, uint8_t axis, uint8_t reaction);

/* The network is STOPPED: axes in operation have to come to rest. */
void ods_axis_network_stopped(ods_node_t *node);

/* One millisecond of one axis. */
void ods_axis_tick(ods_node_t *node, uint8_t axis);

/* Whether the next tick can change anything. */
int ods_axis_is_armed(const ods_node_t *node, uint8_t axis);

/* The statusword follows the state of the axis and of the module. */
void ods_axis_update(ods_node_t *node, uint8_t axis);
void ods_axis_update_all(ods_node_t *node);

#endif
