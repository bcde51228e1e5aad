/* elimination.c: tables of bodies and blocks on a panel, of numbers that come at run time, and how blocks move. */
#ifndef TABLES
#define NAME_RUNTIME
#include "stream/tables.h"
#include "series.h"
#include "joint.c"
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

/* A body on a panel of some length: with q' = rate (p - q) and x_k = rate length / (4 k), q_k + x_k (q_(k-1) - q_(k+1)) =
 * x_k (p_(k-1) - p_(k+1)), q_0 and p_0 counted twice, is eliminated from the highest k down. */
static void OF(tabulate_body)(num (*table)[3], const num *rate, real length, int degree)
{
    const num step = *rate * length;
    num own = ZERO, first = ZERO, last = ZERO;
    for (int k = degree; k > 0; --k) {
        const num above = own;
        own = step / ((real)(4 * k) + step * above);
        first = (real)(k % 2 ? -1 : 1) - above * first;
        last = 1 - above * last;
        table[k][RATIO] = own;
        table[k][SUM_FIRST] = first;
        table[k][SUM_LAST] = last;
    }
    const num less = 2 * own * first;
    table[0][SLACK] = -less / (1 - less);
    table[0][LOSS] = 2 * own * last;
    table[0][2] = ZERO;
}

/* The matrices of a block of n states on a panel, of degree k from k*stride on: x_k = solve r_k + down y_(k+1) - down x_(k-1);
 * `first` and `last` sum to the state at both ends; `start` and `end` belong to x_0. */
typedef struct {
    int n;
    size_t stride;
    num *solve, *down, *first, *last, *start, *end;
} OF(block_tables);

/* With x' = rates x + f on a panel, x and f series, 2 k x_k + G (x_(k-1) - x_(k+1)) = r_k, G = -half the length times
 * rates: eliminated from the highest k down, where x_0 counts twice. */
static void OF(tabulate_block)(const OF(block_tables) *m, const num *rates, real half, int degree)
{
    const int n = m->n;
    num g[MOST_STATES * MOST_STATES], d[MOST_STATES * MOST_STATES];
    num *const ends[2] = {m->first, m->last};
    for (int i = 0; i < n * n; ++i) {
        g[i] = -half * rates[i];
        m->down[(size_t)(degree + 1) * m->stride + (size_t)i] = ZERO;
        m->first[(size_t)(degree + 1) * m->stride + (size_t)i] = ZERO;
        m->last[(size_t)(degree + 1) * m->stride + (size_t)i] = ZERO;
    }
    for (int k = degree; k >= 0; --k) {
        const size_t here = (size_t)k * m->stride, above = here + m->stride;
        const num *const down = m->down + above;
        for (int end = 0; end < 2; ++end) {
            num *const now = ends[end] + here;
            OF(multiply)(ends[end] + above, down, n, now);
            for (int i = 0; i < n * n; ++i) {
                const real one = i % (n + 1) > 0 ? (real)0 : end == 0 && k % 2 ? (real)-1 : (real)1;
                now[i] = one - (real)(k == 0 ? 2 : 1) * now[i];
            }
        }
        if (k > 0) {
            OF(multiply)(g, down, n, d);
            for (int i = 0; i < n; ++i) {
                d[i * n + i] += (real)(2 * k);
            }
            OF(invert)(d, n, m->solve + here);
            OF(multiply)(m->solve + here, g, n, m->down + here);
        }
    }
    for (int i = 0; i < n * n; ++i) {
        d[i] = m->first[i];
        m->end[i] = m->last[i];
    }
    OF(invert)(d, n, m->start);
}

/* How the states of a block move on a panel under f, which has nothing at degree + 1: the series x; `state` goes from its
 * start to its end. */
static void OF(solve_block)(const OF(block_tables) *m, real half, int degree, num (*f)[ROW], num *state, num (*x)[ROW])
{
    const int n = m->n;
    num y[MOST_STATES], r[MOST_STATES], now[MOST_STATES], at_first[MOST_STATES], at_last[MOST_STATES];
    for (int i = 0; i < MOST_STATES; ++i) { /* all, so that no compiler thinks that a sum begins with nothing */
        y[i] = now[i] = at_last[i] = ZERO;
        at_first[i] = i < n ? state[i] : ZERO;
    }
    for (int k = degree; k > 0; --k) {
        const size_t here = (size_t)k * m->stride;
        for (int i = 0; i < n; ++i) {
            r[i] = half * ((k == 1 ? (num)(2 * f[i][0]) : f[i][k - 1]) - f[i][k + 1]);
            now[i] = ZERO;
        }
        OF(add_product)(m->solve + here, r, n, 1, now);
        OF(add_product)(m->down + here, y, n, 1, now);
        OF(add_product)(m->first + here, now, n, -1, at_first);
        OF(add_product)(m->last + here, now, n, 1, at_last);
        for (int i = 0; i < n; ++i) {
            y[i] = x[i][k] = now[i];
        }
    }
    for (int i = 0; i < n; ++i) {
        y[i] = ZERO;
    }
    OF(add_product)(m->start, at_first, n, 1, y);
    OF(add_product)(m->end, y, n, 1, at_last);
    for (int i = 0; i < n; ++i) {
        x[i][0] = y[i];
        x[i][degree + 1] = ZERO;
        state[i] = at_last[i];
        y[i] = 2 * y[i];
    }
    for (int k = 1; k <= degree; ++k) {
        for (int i = 0; i < n; ++i) {
            now[i] = x[i][k];
        }
        OF(add_product)(m->down + (size_t)k * m->stride, y, n, -1, now);
        for (int i = 0; i < n; ++i) {
            y[i] = x[i][k] = now[i];
        }
    }
}
