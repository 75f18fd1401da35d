/*
 * Counts instructions of this machine under callgrind, which is asked for a dump of its counters by name: one for each
 * case, and one for each single look-up. With the name of a case it tells how many operations that has and how many
 * nanoseconds they take.
 */
#include <stdio.h>
#include <string.h>
#include <time.h>
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

/* Natively: how long a case takes, in nanoseconds. */
static int measure_time(const char *name)
{
    for (uint32_t n = 0; n < bench_case_count; n++) {
        if (strcmp(bench_cases[n].name, name) == 0) {
            struct timespec begin;
            struct timespec end;
            const uint32_t count = bench_prepare(&bench_cases[n]);
            clock_gettime(CLOCK_MONOTONIC, &begin);
            for (uint32_t number = 0; number < count; number++) {
                bench_cases[n].operate(number);
            }
            clock_gettime(CLOCK_MONOTONIC, &end);
            printf("%u %.0f\n", (unsigned)count,
                   (double)(end.tv_sec - begin.tv_sec) * 1e9 + (double)(end.tv_nsec - begin.tv_nsec));
            return bench_worked(count) ? 0 : 1;
        }
    }
    return 1;
}

int main(int argc, char **argv)
{
    bench_begin();
    if (argc == 2) {
        return measure_time(argv[1]);
    }
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
