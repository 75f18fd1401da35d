#include "frame_queue.h"

void frame_queue_put(frame_queue_t *queue, const ods_frame_t *frame)
{
    const uint8_t put = queue->put;

    if ((uint8_t)(put - queue->taken) == FRAME_QUEUE_SIZE) {
        queue->lost++;
        return;
    }
    queue->frames[put % FRAME_QUEUE_SIZE] = *frame;
    queue->put = (uint8_t)(put + 1u);
}

int frame_queue_take(frame_queue_t *queue, ods_frame_t *frame)
{
    const uint8_t taken = queue->taken;

    if (taken == queue->put) {
        return 0;
    }
    *frame = queue->frames[taken % FRAME_QUEUE_SIZE];
    queue->taken = (uint8_t)(taken + 1u);
    return 1;
}
