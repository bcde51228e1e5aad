/* polynomials.c: sums of Chebyshev polynomials, and loads as such; models have it twice, for one set of parameters and for
 * a set in each lane of a vector. Where nobody says what a number `num` is, with OF(name) for what is called name, it is
 * real. */
#ifndef TABLES
#include "march/tables.h"
#endif

#ifndef num
#define num real
#define OF(name) name
#define PICK(test, one, other) ((test) ? (one) : (other))
#define SIZE_OF(x) ((x) < 0 ? -(x) : (x))
#define ZERO ((real)0)
#define WITHIN static
#endif

/* sum of c_k T_k(u), where c_k are `stride` apart */
static void OF(series_at)(const num *c, int stride, int degree, real u, num *sum)
{
    const real twice = u + u;
    num next = ZERO, after = ZERO;
    for (int k = degree; k > 0; --k) {
        const num now = (twice * next - after) + c[k * stride];
        after = next;
        next = now;
    }
    *sum = (u * next - after) + c[0];
}

/* The three coefficients of a load on a panel, the `middle` of which is so long after the instant whose powers are given. */
static void OF(load_series)(const num *power, real middle, real half, num *c)
{
    c[0] = (power[0] + middle * power[1]) + (middle * middle + half * half / 2) * power[2];
    c[1] = half * (power[1] + 2 * middle * power[2]);
    c[2] = half * half / 2 * power[2];
}
