/* What port/linux makes of a frame of Linux: CAN-ID and data in hexadecimal as arguments, CAN-ID with its flags. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "socketcan.h"

int main(int argc, char **argv)
{
    struct can_frame from;
    ods_frame_t to;
    ods_can_t events[SOCKETCAN_EVENTS];

    memset(&from, 0, sizeof(from));
    from.can_id = (canid_t)strtoul(argv[1], NULL, 16);
    for (int i = 2; (i < argc) && (i < 10); i++) {
        from.data[i - 2] = (uint8_t)strtoul(argv[i], NULL, 16);
        from.can_dlc = (uint8_t)(i - 1);
    }
    if (socketcan_frame(&from, &to)) {
        printf("frame %03X %u %u", (unsigned)to.id, (unsigned)to.length, (unsigned)to.remote);
        for (uint32_t i = 0; i < to.length; i++) {
            printf(" %02X", (unsigned)to.data[i]);
        }
        putchar('\n');
    }
    const uint32_t count = socketcan_events(&from, events);
    for (uint32_t i = 0; i < count; i++) {
        printf("event %u\n", (unsigned)events[i]);
    }
    return 0;
}
