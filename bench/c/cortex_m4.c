/*
 * Counts instructions of a Cortex-M4 in QEMU, whose clock advances by 1024 ns with each of them (-icount shift=10).
 * SysTick then counts 25 MHz * 1024 ns = 25.6 a instruction, so that every single operation is measured exactly.
 * Prints a line for each case by semihosting: its name, operations, instructions of all and of the worst, in tenths.
 */
#include <stdint.h>

#include "cases.h"

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018u)
#define SYSTICK_MASK 0xFFFFFFu

#define SEMIHOSTING_WRITE 0x04u
#define SEMIHOSTING_EXIT 0x18u
#define EXIT_FINE 0x20026u
#define EXIT_FAILED 0x20023u

extern const uint32_t stack_end;

void start(void);

__attribute__((section(".vectors"), used)) static const uintptr_t vectors[] = {
    (uintptr_t)&stack_end,
    (uintptr_t)start,
};

static void semihosting(uint32_t operation, uintptr_t argument)
{
    register uint32_t r0 __asm("r0") = operation;
    register uintptr_t r1 __asm("r1") = argument;
    __asm volatile("bkpt 0xab"
                   : "+r"(r0)
                   : "r"(r1)
                   : "memory");
}

static void print(const char *text)
{
    semihosting(SEMIHOSTING_WRITE, (uintptr_t)text);
}

static void print_number(uint64_t number)
{
    char text[24];
    char *at = &text[sizeof text - 1];
    *at = '\0';
    do {
        *--at = (char)('0' + (number % 10u));
        number /= 10u;
    } while (number != 0u);
    *--at = ' ';
    print(at);
}

static void measure(const bench_case_t *item)
{
    const uint32_t count = bench_prepare(item);
    uint64_t total = 0;
    uint32_t worst = 0;
    for (uint32_t number = 0; number < count; number++) {
        const uint32_t before = SYSTICK_VALUE;
        item->operate(number);
        const uint32_t ticks = (before - SYSTICK_VALUE) & SYSTICK_MASK;
        total += ticks;
        worst = (ticks > worst) ? ticks : worst;
    }
    print(item->name);
    print_number(count);
    print_number(total * 100u / 256u);
    print_number((uint64_t)worst * 100u / 256u);
    print("\n");
    if (!bench_worked(count)) {
        print(item->name);
        print(": the node did not do what was asked of it\n");
        semihosting(SEMIHOSTING_EXIT, EXIT_FAILED);
    }
}

void start(void)
{
    SYSTICK_RELOAD = SYSTICK_MASK;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 5u; /* the processor's clock, no interrupt */
    bench_begin();
    for (uint32_t n = 0; n < bench_case_count; n++) {
        measure(&bench_cases[n]);
    }
    semihosting(SEMIHOSTING_EXIT, EXIT_FINE);
}
