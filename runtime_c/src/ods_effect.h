/*
 * What writing an entry does (ods_effect_t): the way from a rule of the dictionary to the module that obeys it.
 */
#ifndef ODS_EFFECT_H
#define ODS_EFFECT_H

#include "ods/node.h"

/*
 * Whether the present state of the device forbids the write: 0 or an abort code. What is refused here or below has to
 * be in REFUSING of the generator, which makes their rules ODS_OD_GUARDED.
 */
uint32_t ods_effect_state(const ods_node_t *node, uint32_t instance, uint32_t effect);

/*
 * Whether the effect refuses a value that is in range: 0 or an abort code. A command that may fail is carried out here.
 */
uint32_t ods_effect_check(ods_node_t *node, uint32_t instance, uint32_t effect, uint32_t value);

/* The value is in place. Effects on an axis are not for here, see ods_axis_written(). */
void ods_effect_apply(ods_node_t *node, uint32_t instance, uint32_t effect);

#endif
