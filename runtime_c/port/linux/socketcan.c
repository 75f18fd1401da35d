#define _GNU_SOURCE /* SOCK_NONBLOCK */

#include "socketcan.h"

#include <errno.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* Which bit of an error frame means what. With `status` the bit stands in the octet for the controller. */
typedef struct {
    uint32_t class;
    uint8_t status;
    ods_can_t event;
} socketcan_row_t;

/* Sorted so that of two states the worse one comes last and holds; a controller that was restarted is sound again. */
static const socketcan_row_t rows[SOCKETCAN_EVENTS] = {
    { CAN_ERR_RESTARTED, 0, ODS_CAN_OK },
    { CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE, ODS_CAN_OK },
    { CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING, ODS_CAN_WARNING },
    { CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE, ODS_CAN_PASSIVE },
    { CAN_ERR_BUSOFF, 0, ODS_CAN_BUS_OFF },
    { CAN_ERR_PROT | CAN_ERR_BUSERROR, 0, ODS_CAN_ERROR },
    { CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW, ODS_CAN_OVERRUN },
    { CAN_ERR_CRTL, CAN_ERR_CRTL_TX_OVERFLOW, ODS_CAN_TX_FULL },
};

int socketcan_open(const char *interface)
{
    const can_err_mask_t errors = CAN_ERR_RESTARTED | CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_PROT | CAN_ERR_BUSERROR;
    struct sockaddr_can address;
    const int bus = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK, CAN_RAW);

    if (bus < 0) {
        return -1;
    }
    memset(&address, 0, sizeof(address));
    address.can_family = AF_CAN;
    address.can_ifindex = (int)if_nametoindex(interface);
    if ((address.can_ifindex == 0) ||
        (setsockopt(bus, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof(errors)) != 0) ||
        (bind(bus, (const struct sockaddr *)(const void *)&address, sizeof(address)) != 0)) {
        const int why = errno;
        (void)close(bus);
        errno = why;
        return -1;
    }
    return bus;
}

int socketcan_read(int socket, struct can_frame *frame)
{
    const ssize_t got = read(socket, frame, sizeof(*frame));

    if (got == (ssize_t)sizeof(*frame)) {
        return 1;
    }
    return ((got < 0) && ((errno == EAGAIN) || (errno == EINTR))) ? 0 : -1;
}

int socketcan_write(int socket, const ods_frame_t *frame)
{
    struct can_frame to;

    memset(&to, 0, sizeof(to));
    to.can_id = frame->id | ((frame->remote != 0u) ? CAN_RTR_FLAG : 0u);
    to.can_dlc = frame->length;
    memcpy(to.data, frame->data, sizeof(frame->data));
    return (write(socket, &to, sizeof(to)) == (ssize_t)sizeof(to)) ? 0 : -1;
}

int socketcan_frame(const struct can_frame *from, ods_frame_t *to)
{
    if (((from->can_id & (CAN_ERR_FLAG | CAN_EFF_FLAG)) != 0u) || (from->can_dlc > CAN_MAX_DLEN)) {
        return 0;
    }
    to->id = (uint16_t)(from->can_id & CAN_SFF_MASK);
    to->length = from->can_dlc;
    to->remote = (from->can_id & CAN_RTR_FLAG) != 0u;
    memcpy(to->data, from->data, sizeof(to->data));
    return 1;
}

uint32_t socketcan_events(const struct can_frame *from, ods_can_t events[SOCKETCAN_EVENTS])
{
    uint32_t count = 0;

    if ((from->can_id & CAN_ERR_FLAG) == 0u) {
        return 0;
    }
    for (uint32_t i = 0; i < SOCKETCAN_EVENTS; i++) {
        const socketcan_row_t *const row = &rows[i];
        if (((from->can_id & row->class) != 0u) && ((row->status == 0u) || ((from->data[1] & row->status) != 0u))) {
            events[count] = row->event;
            count++;
        }
    }
    return count;
}
