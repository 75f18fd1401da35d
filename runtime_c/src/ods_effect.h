/*
 * What writing an entry does (ods_effect_t): the way from a rule of the dictionary to the module that obeys it.
 */
#ifndef ODS_EFFECT_H
#define ODS_EFFECT_H

#include "ods_access.h"

/* Whether the present state of the device forbids the write: 0 or an abort code. */
uint32_t ods_effect_state(const ods_node_t *node, const ods_target_t *target, uint8_t effect);

/*
 * Whether the effect refuses a value that is in range: 0 or an abort code. A command that may fail is carried out here.
 */
uint32_t ods_effect_check(ods_node_t *node, const ods_target_t *target, uint8_t effect, uint32_t value);

/* The value is in place. Effects on an axis are not for here, see ods_axis_written(). */
void ods_effect_apply(ods_node_t *node, const ods_target_t *target, uint8_t effect);

#endif
