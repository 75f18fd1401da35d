/*
 * The OS command 1023h (CiA 301, 7.5.2.26): in TMCL mode the firmware carries commands out, here only the protocol is.
 */
#ifndef ODS_OS_COMMAND_H
#define ODS_OS_COMMAND_H

#include "ods/node.h"

/* A command was written: carry it out. */
void ods_os_command_run(ods_node_t *node);

#endif
