/*
 * An axis: its parts, and the order in which a tick goes through them.
 */
#ifndef ODS_AXIS_H
#define ODS_AXIS_H

#include "ods_core.h"

/* ods_axis_t.flags: those that the statusword 6041h shows, at their places there (CiA 402; manual, section 6.1.2). */
#define ODS_AXIS_REACHED 0x0400u /* the target is */
#define ODS_AXIS_CLAMPED 0x0800u /* `target` is not what was asked for, but the limit before it */
#define ODS_AXIS_ACKNOWLEDGED 0x1000u /* the set-point was taken, its bit of the controlword not yet taken back */
#define ODS_AXIS_MOVING 0x4000u /* the velocity is not 0 */
#define ODS_AXIS_BACKWARDS 0x8000u /* the last movement was */

/* And the others. */
#define ODS_AXIS_POWERED 0x0010000u /* the power stage is on */
#define ODS_AXIS_RELEASED 0x0020000u /* the brake is */
#define ODS_AXIS_DRIVEN 0x0040000u /* the motor does not turn freely */
#define ODS_AXIS_ENABLED 0x0080000u /* the axis obeys its mode */
#define ODS_AXIS_WAITING 0x0100000u /* a controlword waits for the end of a transition */
#define ODS_AXIS_HAS_TARGET 0x0200000u /* profile position: `target` counts */
#define ODS_AXIS_CALLED 0x0400000u /* a homing was asked for since the last tick */
#define ODS_AXIS_NEWS 0x0800000u /* the hardware or a parameter may have changed since the last tick */
#define ODS_AXIS_RESTS 0x1000000u /* a tick would change nothing */
#define ODS_AXIS_DEAF 0x2000000u /* the last controlword once more would change nothing */
#define ODS_AXIS_MEASURED 0x4000000u /* 606Ch shows the velocity of the encoder, as the last tick has found */

/* Point an axis to its memory. All the rest of it becomes 0. */
void ods_axis_init(ods_node_t *node, uint8_t axis);

/* As at power-on. The values of the axis have just been set. */
void ods_axis_reset(ods_node_t *node, uint8_t axis);

/*
 * A value with an effect of axes was written, `at` octets from the beginning of its instance. That is one of an axis if
 * the device has axes.
 */
void ods_axis_written(ods_node_t *node, uint32_t instance, uint32_t effect, uint32_t at);

/* What an emergency does to the axis (ods_reaction_t). */
void ods_axis_react(ods_node_t *node, uint8_t axis, uint8_t reaction);

/* The network is STOPPED: axes in operation have to come to rest. */
void ods_axis_network_stopped(ods_node_t *node);

/* One millisecond of all axes. */
void ods_axis_tick_all(ods_node_t *node);

/* Something came in, which this tick or the next one has to look at. */
static inline void ods_axis_wake(ods_axis_t *axis)
{
    axis->flags = (axis->flags & ~ODS_AXIS_RESTS) | ODS_AXIS_NEWS;
}

/* Statuswords, positions and outputs follow the state of the axes and of the module. */
void ods_axis_update_all(ods_node_t *node);

/* Tell the outputs that have changed. */
void ods_axis_put_all(const ods_node_t *node);

/* A value of the axis that a TPDO may carry has changed. */
static inline void ods_axis_changed(ods_node_t *node, const ods_axis_t *axis)
{
    ods_value_changed(node, ods_axis_instance(node, axis->number));
}

#endif
