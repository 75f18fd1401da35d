/*
 * The testee as a shared library: what testee.c has, and a function that would be slow by lines.
 */
#include "testee.c"

void testee_controlwords(testee_t *testee, uint8_t axis, uint32_t results[0x10000]);

static uint32_t statusword(const ods_node_t *node, uint16_t index)
{
    uint8_t octets[2] = { 0 };
    uint16_t length;

    (void)ods_node_read(node, index, 0, octets, sizeof(octets), &length);
    return octets[0] | ((uint32_t)octets[1] << 8);
}

/*
 * What each controlword would make of an axis as it is now: the statusword behind it, and in bit 16 whether its motor has
 * current then. The device stays what it is.
 */
void testee_controlwords(testee_t *bench, uint8_t axis, uint32_t results[0x10000])
{
    const uint16_t shift = (uint16_t)(axis * 0x800u);
    const uint16_t controlword = (uint16_t)(0x6040u + shift);
    ods_node_t *const node = &bench->drive.node;
    const ods_simulation_t hardware = bench->hardware[axis];
    DEVICE_TYPE drive;
    ods_frame_t frame = { 0, 8, 0, { 0x2B, (uint8_t)controlword, (uint8_t)(controlword >> 8), 0, 0, 0, 0, 0 } };

    memcpy(&drive, &bench->drive, sizeof(drive));
    frame.id = (uint16_t)(0x600u + node->id);
    for (uint32_t word = 0; word < 0x10000u; word++) {
        frame.data[4] = (uint8_t)word;
        frame.data[5] = (uint8_t)(word >> 8);
        ods_node_receive(node, bench->now, &frame);
        results[word] = statusword(node, (uint16_t)(0x6041u + shift));
        results[word] |= (bench->hardware[axis].current != 0u) ? 0x10000u : 0u;
        memcpy(&bench->drive, &drive, sizeof(drive));
        bench->hardware[axis] = hardware;
        bench->answer.length = 0;
    }
}
