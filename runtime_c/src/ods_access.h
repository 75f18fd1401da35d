/*
 * Access to an entry by its owner's rules: what an SDO and an RPDO have in common.
 *
 * A write is checked in this order: access, length, the present state, the value, what the effect refuses. Nothing
 * changes before all of it has passed.
 */
#ifndef ODS_ACCESS_H
#define ODS_ACCESS_H

#include "ods/node.h"

/* Whether an entry may be read now: 0 or an abort code. */
uint32_t ods_access_readable(const ods_node_t *node, const ods_od_ref_t *ref);

/* Whether an entry takes so many octets: 0 or an abort code. */
uint32_t ods_access_length(const ods_node_t *node, const ods_od_entry_t *entry, uint32_t length);

/*
 * Write a number of up to 4 octets; bits above those of the type are not looked at. 0 or an abort code. An SDO tells
 * its address in node->sdo.address; effects that ask for it cannot be mapped.
 */
uint32_t ods_access_write_number(
    ods_node_t *node, const ods_od_entry_t *entry, uint32_t instance, uint32_t number);

/* Write any entry; the number of octets has been checked. 0 or an abort code. */
uint32_t ods_access_write(ods_node_t *node, const ods_od_ref_t *ref, const uint8_t *octets, uint16_t length);

#endif
