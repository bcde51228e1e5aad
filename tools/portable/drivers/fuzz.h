/* fuzz.h: what the bytes of a fuzzer say, and what it is told where something does not hold.
 * Every driver has it; the compiler is given the header of the program, called `name` here, before all else. */
#ifndef FUZZ_H
#define FUZZ_H
#include <float.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

/* A fuzzer takes the end of the process for a fault, and keeps the bytes. */
#define MUST(what) ((what) ? (void)0 : broken(#what, __LINE__))

static void broken(const char *what, int line)
{
    fprintf(stderr, "does not hold: %s, line %d\n", what, line);
    abort();
}

/* What is left of the bytes; 0 for ever after them. */
typedef struct {
    const uint8_t *at;
    size_t left;
} told;

static int choice(told *t, int among)
{
    int chosen = 0;
    if (t->left > 0) {
        chosen = *t->at % among;
        t->at += 1;
        t->left -= 1;
    }
    return chosen;
}

static const int single = sizeof(name_real) == sizeof(float);

/* The number that is so many numbers away. */
static name_real beside(name_real x, int numbers)
{
    unsigned char kept[sizeof x];
    memcpy(kept, &x, sizeof x);
    if (single) {
        uint32_t bits;
        memcpy(&bits, kept, sizeof bits);
        bits += (uint32_t)numbers;
        memcpy(kept, &bits, sizeof bits);
    } else {
        uint64_t bits;
        memcpy(&bits, kept, sizeof bits);
        bits += (uint64_t)numbers;
        memcpy(kept, &bits, sizeof bits);
    }
    memcpy(&x, kept, sizeof x);
    return x;
}

static name_real power_of_two(int power)
{
    name_real x = 1;
    for (; power > 0; --power) {
        x *= 2;
    }
    for (; power < 0; ++power) {
        x /= 2;
    }
    return x;
}

/* Any number: all there are, and more often those that users give or that are the last of their kind. */
static name_real number(told *t)
{
    const volatile name_real zero = 0;
    const name_real largest = single ? (name_real)FLT_MAX : (name_real)DBL_MAX;
    const name_real least = single ? (name_real)FLT_MIN : (name_real)DBL_MIN;
    const name_real last[] = {0, -zero, zero / zero, 1 / zero, -1 / zero, largest, -largest, least, beside(0, 1), 1};
    const int kind = choice(t, 8);
    const int some = choice(t, 256);
    switch (kind) {
    case 0:
        return (name_real)some;
    case 1:
        return (name_real)some / 8 - 8;
    case 2:
        return beside((name_real)some / 8, choice(t, 7) - 3);
    case 3:
        return NAME_TAU_MAX * (name_real)some / 64;
    case 4:
        return (name_real)(choice(t, 64) - 32) * power_of_two(single ? some - 128 : 8 * (some - 128));
    case 5:
        return last[some % 10];
    case 6:
        return beside(NAME_TAU_MAX, some - 128);
    default: {
        name_real x = 0;
        unsigned char bits[sizeof x];
        for (size_t k = 0; k < sizeof x; ++k) {
            bits[k] = (unsigned char)choice(t, 256);
        }
        memcpy(&x, bits, sizeof x);
        return x;
    }
    }
}

/* Neither infinite nor NaN. */
static int finite(name_real x)
{
    return x - x == 0;
}

static name_real size_of(name_real x)
{
    return x < 0 ? -x : x;
}

static name_real rounding(void)
{
    return single ? (name_real)FLT_EPSILON : (name_real)DBL_EPSILON;
}

static int all_finite(const name_real *values, size_t count)
{
    int all = 1;
    for (size_t k = 0; k < count; ++k) {
        all &= finite(values[k]);
    }
    return all;
}

static int all_nan(const name_real *values, size_t count)
{
    int all = 1;
    for (size_t k = 0; k < count; ++k) {
        all &= values[k] != values[k];
    }
    return all;
}

static int in_range(name_real tau)
{
    return tau >= 0 && tau <= NAME_TAU_MAX;
}

/* Room for so many numbers and no more: a sanitizer sees what is beyond. */
static name_real *room(size_t count)
{
    name_real *const numbers = (name_real *)malloc(count * sizeof(name_real) + (count == 0));
    MUST(numbers != NULL);
    return numbers;
}

#endif
