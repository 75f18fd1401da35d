/*
 * Stored values (1010h, 1011h): one record, two banks of non-volatile memory.
 *
 * A record is written to the bank that is not in force. Its header comes last, so that at any loss of power one whole
 * record remains: the new one once the last octet of its header is there, the old one before.
 *
 *     header   layout hash of the dictionary (32 bits), sequence number (16), octets of the payload (16), CRC-32 of
 *              these 8 octets and the payload
 *     payload  storage groups that hold values: 16 bits for the device, then for each axis, bit 1 << (group - 1)
 *              the values, instance by instance, in each by index and sub-index; those of other groups are 0
 *
 * Everything is little-endian. The newest valid record is in force: sequence numbers are compared as they wrap. A
 * record with another layout hash is from another firmware, and not read. A value that is no longer in its range keeps
 * its default.
 */
#ifndef ODS_STORE_H
#define ODS_STORE_H

#include "ods/node.h"

/* Find the record in force and take its values over: all of them, or those of 1000h to 1FFFh. */
void ods_store_load(ods_node_t *node, int communication_only);

/* What writing a signature to 1010h or 1011h does. Returns 0, or the abort code of a memory that fails. */
uint32_t ods_store_save(ods_node_t *node, uint16_t index, uint8_t sub);
uint32_t ods_store_restore(ods_node_t *node, uint16_t index, uint8_t sub);

#endif
