/*
 * What is measured, the same for every machine: operations of a node, one at a time. A machine brings `main` and a way
 * to count instructions.
 *
 * Each operation is called through a pointer, as the peers' were. What that costs is measured as well, by operations
 * that do nothing but what the others do around the node: `call` calls a function, `call_and_send` calls one that sends
 * a frame.
 */
#ifndef ODS_BENCH_CASES_H
#define ODS_BENCH_CASES_H

#include <stdint.h>

typedef struct {
    const char *name;
    uint32_t (*prepare)(void); /* returns how many operations there are */
    void (*operate)(uint32_t number);
} bench_case_t;

extern const bench_case_t bench_cases[];
extern const uint32_t bench_case_count;

/* Set the node up. Once, before the first case. */
void bench_begin(void);

/* Set a case up. Returns how many operations there are. */
uint32_t bench_prepare(const bench_case_t *item);

/* Whether the node did in so many operations what the case is about: it sent as many frames as it should have. */
int bench_worked(uint32_t operations);

#endif
