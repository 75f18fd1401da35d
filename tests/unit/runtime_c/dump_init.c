/*
 * Stands in for the runtime's ods_node_init(): prints how many elements of each array in the memory of a node the
 * device needs, and fails unless there is room for them. The arrays are filled and must not touch each other.
 * Compile with -DNODE_HEADER='"x.h"', -DNODE=x_t, -DINIT=x_init and -DDEVICE=x_device.
 */
#include NODE_HEADER

#include <stdio.h>
#include <string.h>

typedef struct {
    const char *name;
    void *begin;
    size_t count;
    size_t size; /* octets of an element */
} array_t;

enum {
    ARRAYS = 6
};

static NODE memory_of_node;
static const ods_port_t the_port;
static const ods_config_t the_config = { 4711, 5 };
static int failures;

static void expect(int holds, const char *what)
{
    if (!holds) {
        printf("FAILED %s\n", what);
        failures++;
    }
}

static void fill(const array_t *arrays)
{
    const unsigned char *const from = (const unsigned char *)&memory_of_node;
    for (size_t n = 0; n < ARRAYS; n++) {
        const array_t *const array = &arrays[n];
        printf("%s %u\n", array->name, (unsigned)array->count);
        expect((array->begin != NULL) == (array->count > 0u), array->name);
        if (array->begin != NULL) {
            const unsigned char *const begin = (const unsigned char *)array->begin;
            const size_t octets = array->count * array->size;
            expect((begin >= from) && (begin + octets <= from + sizeof(memory_of_node)), array->name);
            memset(array->begin, (int)n + 1, octets);
        }
    }
    for (size_t n = 0; n < ARRAYS; n++) {
        const unsigned char *const octets = (const unsigned char *)arrays[n].begin;
        for (size_t at = 0; (octets != NULL) && (at < arrays[n].count * arrays[n].size); at++) {
            expect(octets[at] == n + 1u, arrays[n].name);
        }
    }
    for (size_t at = 0; at < sizeof(memory_of_node.node); at++) {
        expect(((const unsigned char *)&memory_of_node.node)[at] == 0u, "the node");
    }
}

void ods_node_init(
    ods_node_t *node,
    const ods_device_t *device,
    const ods_memory_t *memory,
    const ods_port_t *port,
    const ods_config_t *config)
{
    const ods_od_t *const od = device->od;
    const size_t rpdos = (size_t)od->scope_instances[ODS_SCOPE_RPDO + 1] - od->scope_instances[ODS_SCOPE_RPDO];
    const size_t tpdos = (size_t)od->scope_instances[ODS_SCOPE_TPDO + 1] - od->scope_instances[ODS_SCOPE_TPDO];
    const array_t arrays[ARRAYS] = {
        { "values", memory->values, 1, od->values_size },
        { "axes", memory->axes, device->axes, sizeof(ods_axis_t) },
        { "rpdos", memory->rpdos, rpdos, sizeof(ods_rpdo_t) },
        { "tpdos", memory->tpdos, tpdos, sizeof(ods_tpdo_t) },
        { "mapped", memory->mapped, (rpdos + tpdos) * od->max_mapped, sizeof(ods_pdo_ref_t) },
        { "buffer", memory->buffer, od->buffer_size, 1 },
    };
    expect(node == &memory_of_node.node, "node");
    expect(device == &DEVICE, "device");
    expect((port == &the_port) && (config == &the_config), "port and config");
    fill(arrays);
}

int main(void)
{
    INIT(&memory_of_node, &the_port, &the_config);
    return failures;
}
