/*
 * The programs that print the tables of a device, as functions: dump_od() asks for all addresses, dump_known() for those
 * of some objects, dump_indices() for the first two sub-indices of every index.
 */
#define main dump_od
#include "dump_od.c"
#undef main

int dump_known(const uint16_t *indices, unsigned count)
{
    int wrong;

    od = DEVICE.od;
    values = malloc(od->values_size);
    power_on();
    wrong = compare_tables();
    for (unsigned n = 0; n < count; n++) {
        wrong |= print_object(indices[n]);
    }
    free(values);
    return wrong;
}

int dump_indices(void)
{
    for (unsigned index = 0; index <= 0xFFFFu; index++) {
        for (unsigned sub = 0; sub < 2u; sub++) {
            ods_od_ref_t ref;
            const uint32_t abort_code = ods_od_find(DEVICE.od, (uint16_t)index, (uint8_t)sub, &ref);
            if (abort_code != ODS_ABORT_NO_OBJECT) {
                printf("%04X:%u %u\n", index, sub, abort_code == 0u);
            }
        }
    }
    return 0;
}

#define main dump_device
#include "dump_device.c"
