/*
 * PDOs: their parameters, and data on its way in and out (CiA 301, 7.2.2, 7.5.2.35 to 7.5.2.38).
 *
 * A PDO is known by its ordinal, counted from 0 over all axes; its instance in the dictionary is that of the first one
 * plus the ordinal. Mappings are resolved once, when they come into force.
 */
#ifndef ODS_PDO_H
#define ODS_PDO_H

#include "ods/node.h"

/* ---- parameters: 0 or an abort code ------------------------------------------------------------------------------ */

uint32_t ods_pdo_mapping_state(const ods_node_t *node, uint32_t instance, uint32_t sub);
uint32_t ods_pdo_check_cob_id(const ods_node_t *node, uint32_t instance, uint32_t cob_id);
uint32_t ods_pdo_check_count(const ods_node_t *node, uint32_t instance, uint32_t count);
uint32_t ods_pdo_check_mapping(const ods_node_t *node, uint32_t instance, uint32_t sub, uint32_t mapping);

/* The COB-ID of a PDO was written: it starts, stops or goes on. */
void ods_pdo_cob_id_written(ods_node_t *node, uint32_t instance);

/* A mapping entry or (sub-index 0) their number was written. What is in force now starts afresh. */
void ods_pdo_mapping_written(ods_node_t *node, uint32_t instance, uint32_t sub);

/* A parameter was written that is in force at any time: transmission type, inhibit time or event timer. */
void ods_pdo_parameter_written(ods_node_t *node, uint32_t instance, uint32_t sub);

/* ---- operation --------------------------------------------------------------------------------------------------- */

/* All parameters are new: after a reset. */
void ods_pdo_reset(ods_node_t *node);

/* OPERATIONAL begins. */
void ods_pdo_start(ods_node_t *node);

/* A frame that may be one or several RPDOs. */
void ods_pdo_receive(ods_node_t *node, const ods_frame_t *frame);

/* A SYNC came. */
void ods_pdo_sync(ods_node_t *node);

/* The earliest instant at which a TPDO becomes due, or `at` if that is earlier. */
uint32_t ods_pdo_earliest(const ods_node_t *node, uint32_t at);

/* Event timers and inhibit times that end now. */
void ods_pdo_expire(ods_node_t *node);

/* Send what is due, in ascending order. */
void ods_pdo_transmit(ods_node_t *node);

#endif
