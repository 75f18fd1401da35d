/*
 * The state machine of an axis (PDS FSA, CiA 402).
 *
 * Which command or event leads from where to where is in the device's table. Here is what a transition does, and what
 * makes it take time: power stage and brake have delays, and an axis that moves has to come to rest before its power
 * goes off. While a commanded transition takes time, the last controlword written waits for its end (manual, section
 * 6.1).
 */
#ifndef ODS_FSA_H
#define ODS_FSA_H

#include "ods_axis.h"

/* ods_axis_t.phase: what a transition waits for. */
typedef enum {
    ODS_PHASE_NONE,
    ODS_PHASE_POWERING, /* the power stage has to build up its current (200Ah) */
    ODS_PHASE_RELEASING, /* the brake has to open (2002h:02) */
    ODS_PHASE_SLOWING, /* the axis has to come to rest */
    ODS_PHASE_APPLYING /* the brake has to close (2002h:01) */
} ods_phase_t;

/* ods_axis_t.stop: whether the state machine stops the axis, and on which slope. */
typedef enum {
    ODS_STOP_NONE,
    ODS_STOP_MODE_RAMP, /* the slow-down ramp of the mode */
    ODS_STOP_QUICK_STOP_RAMP /* 6085h */
} ods_stop_t;

/* Transitions 0 and 1, at power-on. */
void ods_fsa_reset(const ods_node_t *node, ods_axis_t *axis);

/* Whether the axis obeys its mode. */
static inline int ods_fsa_is_enabled(const ods_axis_t *axis)
{
    return (axis->flags & ODS_AXIS_ENABLED) != 0u;
}

/* A controlword was written. Whether anything may have come of it. */
int ods_fsa_command(ods_node_t *node, ods_axis_t *axis, uint16_t word);

/* Something has changed that gives the same controlword another meaning. */
static inline void ods_fsa_listen(ods_axis_t *axis)
{
    axis->flags &= ~ODS_AXIS_DEAF;
}

/* An emergency with the reaction of a fault was raised: transition 13; `off`: there is no power left to brake. */
void ods_fsa_fault(ods_node_t *node, ods_axis_t *axis, int off);

/* The NMT state STOPPED makes an axis faulty that is in operation (manual, section 2.2), or on its way there. */
void ods_fsa_network_stopped(ods_node_t *node, ods_axis_t *axis);

/* A tick of an axis whose phase is not ODS_PHASE_NONE. */
void ods_fsa_tick(ods_node_t *node, ods_axis_t *axis);

#endif
