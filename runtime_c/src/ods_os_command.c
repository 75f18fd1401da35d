#include "ods_os_command.h"

#include <string.h>

#include "ods_core.h"

ODS_STATIC_ASSERT(command_fits, sizeof((ods_device_values_t *)0)->os_command == ODS_OS_COMMAND_SIZE);
ODS_STATIC_ASSERT(reply_fits, sizeof((ods_device_values_t *)0)->os_reply == ODS_OS_COMMAND_SIZE);

void ods_os_command_run(ods_node_t *node)
{
    ods_device_values_t *const values = node->common;
    ods_os_status_t status = ODS_OS_FAILED;

    memset(values->os_reply, 0, sizeof values->os_reply);
    if (node->port->os_command != NULL) {
        status = node->port->os_command(node->port->context, values->os_command, values->os_reply);
    }
    if ((status == ODS_OS_DONE) || (status == ODS_OS_FAILED)) {
        memset(values->os_reply, 0, sizeof values->os_reply); /* there is none */
    }
    values->os_status = (uint8_t)status;
}
