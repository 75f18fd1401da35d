/*
 * Counts instructions of this machine under callgrind, which is asked for a dump of its counters by name: one for each
 * case, and one for each single look-up.
 */
#include <stdio.h>
#include <string.h>
#include <valgrind/callgrind.h>

#include "cases.h"

/* The instructions of single operations, for the worst of them. */
static void measure_singly(const bench_case_t *item)
{
    const uint32_t count = bench_prepare(item);
    char name[40];
    for (uint32_t number = 0; number < count; number++) {
        snprintf(name, sizeof name, "single_%s %u", item->name, 1u);
        CALLGRIND_ZERO_STATS;
        item->operate(number);
        CALLGRIND_DUMP_STATS_AT(name);
    }
}

int main(void)
{
    bench_begin();
    for (uint32_t n = 0; n < bench_case_count; n++) {
        const bench_case_t *const item = &bench_cases[n];
        const uint32_t count = bench_prepare(item);
        char name[40];
        snprintf(name, sizeof name, "%s %u", item->name, (unsigned)count);
        CALLGRIND_ZERO_STATS;
        for (uint32_t number = 0; number < count; number++) {
            item->operate(number);
        }
        CALLGRIND_DUMP_STATS_AT(name);
        if (!bench_worked(count)) {
            fprintf(stderr, "%s: the node did not do what was asked of it\n", item->name);
            return 1;
        }
        if (strncmp(item->name, "find", 4) == 0) {
            measure_singly(item);
        }
    }
    return 0;
}
