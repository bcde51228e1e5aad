/* series.h: Chebyshev series of DEGREE, as marches and streams read them. */
#include "apart.h"
#include "polynomials.c"

static void clear(real *y, int count)
{
    for (int k = 0; k < count; ++k) {
        y[k] = 0;
    }
}

/* y += factor a */
static void add(real *y, real factor, const real *a, int count)
{
    for (int k = 0; k < count; ++k) {
        y[k] += factor * a[k];
    }
}

/* sum of c_k T_k(u) */
static real series(const real *c, real u)
{
    real sum;
    series_at(c, 1, DEGREE, u, &sum);
    return sum;
}

/* Its antiderivative, times 1 / half the length of the panel. */
static real antiderivative(const real *c, real u)
{
    const real twice = u + u;
    real next = 0;
    real after = 0;
    for (int k = DEGREE + 1; k > 0; --k) {
        const real lower = k == 1 ? 2 * c[0] : c[k - 1];
        const real upper = k < DEGREE ? c[k + 1] : (real)0;
        const real now = (twice * next - after) + (lower - upper) / (real)(2 * k);
        after = next;
        next = now;
    }
    return u * next - after;
}
