/*
 * A CAN bus of Linux: the socket, and what its frames mean to a node.
 */
#ifndef SOCKETCAN_H
#define SOCKETCAN_H

#include <linux/can.h>
#include <stdint.h>

#include "ods/port.h"

/* Open a socket that never blocks and hears the frames and the errors of an interface. -1 on failure, see errno. */
int socketcan_open(const char *interface);

/* Read what came next: 1, 0 if there is nothing, -1 on failure. */
int socketcan_read(int socket, struct can_frame *frame);

/* Hand a frame to the driver. 0, or -1 if it has no room for it. */
int socketcan_write(int socket, const ods_frame_t *frame);

/* 1 if a frame is one that a node may see, which is then in `to`. */
int socketcan_frame(const struct can_frame *from, ods_frame_t *to);

#define SOCKETCAN_EVENTS 8u

/* What an error frame reports, in the order in which the node has to be told. Gives their number; 0: another frame. */
uint32_t socketcan_events(const struct can_frame *from, ods_can_t events[SOCKETCAN_EVENTS]);

#endif
