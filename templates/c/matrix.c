/* matrix.c: square matrices of a few rows, of numbers that come at run time. Where nobody says what a number `num` is, with
 * OF(name) for what is called name, it is real. Generated files have what stands below the first empty line. */
#if !defined(num) && !defined(TABLES)
#include "name.h"
#include "real.h"
#endif

#ifndef num
#define num real
#define OF(name) name
#define PICK(test, one, other) ((test) ? (one) : (other))
#define SIZE_OF(x) ((x) < 0 ? -(x) : (x))
#define ZERO ((real)0)
#define WITHIN static
#endif

/* c = a b, of n rows and columns */
static void OF(multiply)(const num *a, const num *b, int n, num *c)
{
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            num sum = ZERO;
            for (int k = 0; k < n; ++k) {
                sum += a[i * n + k] * b[k * n + j];
            }
            c[i * n + j] = sum;
        }
    }
}

/* y += factor a x */
WITHIN void OF(add_product)(const num *a, const num *x, int n, real factor, num *y)
{
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            y[i] += factor * (a[i * n + k] * x[k]);
        }
    }
}

/* Put the larger of two first numbers of rows where it is divided by. */
static void OF(exchange)(num *a, num *b, int n, int one, int other)
{
    const num first = SIZE_OF(a[one * n + one]), second = SIZE_OF(a[other * n + one]);
    for (int j = 0; j < n; ++j) {
        const num u = a[one * n + j], v = b[one * n + j], w = a[other * n + j], z = b[other * n + j];
        a[one * n + j] = PICK(second > first, w, u);
        a[other * n + j] = PICK(second > first, u, w);
        b[one * n + j] = PICK(second > first, z, v);
        b[other * n + j] = PICK(second > first, v, z);
    }
}

/* The inverse of a, which is lost; where there is none it is no number. */
static void OF(invert)(num *a, int n, num *b)
{
    for (int i = 0; i < n * n; ++i) {
        b[i] = ZERO + (i % (n + 1) == 0 ? (real)1 : (real)0);
    }
    for (int k = 0; k < n; ++k) {
        for (int i = k + 1; i < n; ++i) {
            OF(exchange)(a, b, n, k, i);
        }
        const num first = 1 / a[k * n + k];
        for (int j = 0; j < n; ++j) {
            a[k * n + j] *= first;
            b[k * n + j] *= first;
        }
        for (int i = 0; i < n; ++i) {
            const num factor = a[i * n + k];
            for (int j = 0; i != k && j < n; ++j) {
                a[i * n + j] -= factor * a[k * n + j];
                b[i * n + j] -= factor * b[k * n + j];
            }
        }
    }
}
