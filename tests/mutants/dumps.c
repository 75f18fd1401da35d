/*
 * The programs that print the tables of a device, as functions: dump_od() asks for all addresses, dump_known() for those
 * of some objects.
 */
#define main dump_od
#include "dump_od.c"
#undef main

int dump_known(const uint16_t *indices, unsigned count)
{
    int wrong = 0;

    od = DEVICE.od;
    values = malloc(od->values_size);
    power_on();
    for (unsigned n = 0; n < count; n++) {
        wrong |= print_object(indices[n]);
    }
    free(values);
    return wrong;
}

#define main dump_device
#include "dump_device.c"
