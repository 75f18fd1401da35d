/*
 * Inputs and outputs of the whole module: general purpose inputs and outputs, analog inputs, the enable input, and
 * those of an I/O module by CiA 401.
 */
#ifndef ODS_IO_H
#define ODS_IO_H

#include "ods/node.h"

/* As at power-on: no output is set. */
void ods_io_reset(ods_node_t *node);

/* An input has a new value. */
void ods_io_set(ods_node_t *node, ods_input_t input, uint8_t channel, uint32_t value);

/* Sample the inputs. */
void ods_io_tick(ods_node_t *node);

/* Tell the port the outputs that have changed; at power-on all of them. */
void ods_io_put(ods_node_t *node, int all);

#endif
