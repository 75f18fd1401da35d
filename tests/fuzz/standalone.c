/*
 * Runs the target without libFuzzer, for compilers that lack it:
 *
 *     standalone FILE...               each file is an input
 *     standalone --random SEED COUNT   COUNT inputs made up from SEED
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *octets, size_t size);

#define LARGEST 4096u

static uint64_t state;

/* SplitMix64. */
static uint64_t random_number(void)
{
    uint64_t z = (state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

/* Blocks of exactly the size of the input, so that a sanitizer sees a read behind it. */
static void run(const uint8_t *octets, size_t size)
{
    uint8_t *const copy = malloc((size == 0u) ? 1u : size);
    if (copy == NULL) {
        exit(2);
    }
    memcpy(copy, octets, size);
    LLVMFuzzerTestOneInput(copy, size);
    free(copy);
}

static void run_random(uint64_t seed, unsigned long count)
{
    static uint8_t octets[LARGEST];
    state = seed;
    for (unsigned long n = 0; n < count; n++) {
        const size_t size = (size_t)(random_number() % LARGEST);
        for (size_t at = 0; at < size; at++) {
            octets[at] = (uint8_t)random_number();
        }
        run(octets, size);
    }
}

static void run_file(const char *name)
{
    static uint8_t octets[1u << 20];
    FILE *const file = fopen(name, "rb");
    if (file == NULL) {
        perror(name);
        exit(2);
    }
    const size_t size = fread(octets, 1, sizeof octets, file);
    fclose(file);
    run(octets, size);
}

int main(int argc, char **argv)
{
    LLVMFuzzerInitialize(&argc, &argv);
    if ((argc == 4) && (strcmp(argv[1], "--random") == 0)) {
        run_random(strtoull(argv[2], NULL, 0), strtoul(argv[3], NULL, 0));
        return 0;
    }
    for (int n = 1; n < argc; n++) {
        run_file(argv[n]);
    }
    return 0;
}
