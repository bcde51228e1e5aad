/* shapes.c: how far places move in the modes.
 * Plain C that stands below the text of frequencies.c in generated files, which have what stands below the first empty line. */
#include "frequencies.c"

/* Of a mode cot and 1/sin of its frequency times each delay. */
typedef struct {
    real angle[BARS + 1];
    real cosine[BARS + 1];
    real cot[BARS + 1];
    real csc[BARS + 1];
} angles;

static void angles_of(const chain *c, real w, angles *a)
{
    for (int bar = 0; bar < BARS; ++bar) {
        a->angle[bar] = w * c->delay[bar];
        a->cosine[bar] = cos(a->angle[bar]);
        a->csc[bar] = 1 / sin(a->angle[bar]);
        a->cot[bar] = a->cosine[bar] * a->csc[bar];
    }
}

/* What is left of the parent of each row once all but the row's own branch is eliminated. */
static void eliminate_beyond(const real *diagonal, const real *pivot, const real *up, real *beyond)
{
    for (int row = ROWS - 1; row >= 0; --row) {
        const int on = parent[row];
        if (on < 0) {
            beyond[row] = pivot[row];
            continue;
        }
        beyond[row] = diagonal[on];
        for (int other = beside[row]; other != row; other = beside[other]) {
            beyond[row] -= up[other] * up[other] / pivot[other];
        }
        if (parent[on] >= 0) {
            beyond[row] -= up[on] * up[on] / beyond[on];
        }
    }
}

/* Absolute values of the terms of q^T K q. */
static real energy(const real *diagonal, const real *up, const real *moved)
{
    real total = 0;
    for (int row = 0; row < ROWS; ++row) {
        total += diagonal[row] * moved[row] * moved[row];
        total += parent[row] < 0 ? 0 : 2 * fabs(up[row] * moved[row] * moved[parent[row]]);
    }
    return total;
}

/* The mass of a shape, that of bars included. */
static real moved_mass(const chain *c, const angles *a, real w, const real *moved)
{
    real total = 0;
    for (int row = 0; row < ROWS; ++row) {
        total += c->mass[row] * moved[row] * moved[row];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real t = c->delay[bar];
        const real s = a->csc[bar];
        const real left = bar_left_ratio[bar] * moved[bar_left[bar]];
        const real right = bar_right_ratio[bar] * moved[bar_right[bar]];
        const real same = (t * s * s - a->cot[bar] / w) / 2;
        const real other = s / w - t * a->cot[bar] * s;
        total += c->impedance[bar] * (same * (left * left + right * right) + other * left * right);
    }
    return total;
}

/* The row on which the least is left once all others are eliminated. */
static int loose_row(const real *pivot, const real *up, const real *beyond)
{
    int root = 0;
    real least = -1;
    for (int row = 0; row < ROWS; ++row) {
        const real left = fabs(parent[row] < 0 ? pivot[row] : pivot[row] - up[row] * up[row] / beyond[row]);
        if (left < least || (least < 0 && left >= 0)) {
            least = left;
            root = row;
        }
    }
    return root;
}

/* The mode of mass 1 with frequency w. K is eliminated from the tips and from the root; in the row on which the least is
 * left a mode needs no force, and from there its shape is what each branch does (Parlett and Dhillon 1997).
 * By rounding w^2 is about as `wrong`, and the shape as `blurred`, relative to its size. */
static void find_shape(const chain *c, const angles *a, real w, real *moved, real *wrong, real *blurred)
{
    real pulled[BARS + 1];
    real shared[BARS + 1];
    real diagonal[PLACES + 1];
    real pivot[PLACES + 1];
    real up[PLACES + 1];
    real beyond[ROWS];
    int towards[ROWS];
    for (int bar = 0; bar < BARS; ++bar) {
        pulled[bar] = w * a->cot[bar];
        shared[bar] = -w * a->csc[bar];
    }
    assemble(c, w * w, pulled, shared, diagonal, up);
    assemble(c, w * w, pulled, shared, pivot, up);
    eliminate(pivot, up);
    eliminate_beyond(diagonal, pivot, up, beyond);
    for (int place = 0; place < PLACES; ++place) {
        moved[place] = 0;
    }
    for (int row = 0; row < ROWS; ++row) {
        towards[row] = 0;
    }
    const int root = loose_row(pivot, up, beyond);
    moved[root] = 1;
    towards[root] = 1;
    for (int row = root; parent[row] >= 0; row = parent[row]) {
        moved[parent[row]] = -up[row] * moved[row] / beyond[row];
        towards[parent[row]] = 1;
    }
    for (int row = ROWS - 1; row >= 0; --row) {
        if (!towards[row] && parent[row] >= 0) {
            moved[row] = -up[row] * moved[parent[row]] / pivot[row];
        }
    }
    const real scale = 1 / sqrt(moved_mass(c, a, w, moved));
    for (int row = 0; row < ROWS; ++row) {
        moved[row] *= scale;
    }
    /* an angle is as wrong as its last digit: near a resonance of a bar that counts */
    for (int bar = 0; bar < BARS; ++bar) {
        const real s = fabs(a->csc[bar]);
        const real cot = fabs(a->cot[bar]);
        pulled[bar] = w * (cot + a->angle[bar] * s * s);
        shared[bar] = w * s * (1 + a->angle[bar] * cot);
    }
    assemble(c, -w * w, pulled, shared, diagonal, up);
    *wrong = 4 * DBL_EPSILON * energy(diagonal, up, moved);
    /* so do terms of the mass of bars, which nearly cancel where points are nearly at rest */
    for (int bar = 0; bar < BARS; ++bar) {
        const real s = fabs(a->csc[bar]);
        pulled[bar] = c->delay[bar] * s * s * (1 + a->angle[bar] * s);
    }
    assemble(c, 0, pulled, pulled, diagonal, up);
    *blurred = 4 * DBL_EPSILON * energy(diagonal, up, moved);
}

/* The strain at the end of a bar, times its speed, in a mode. */
static real slope_of_mode(const chain *c, const angles *a, real w, const real *moved, int bar, int side)
{
    const real left = bar_left_ratio[bar] * moved[bar_left[bar]];
    const real right = bar_right_ratio[bar] * moved[bar_right[bar]];
    (void)c;
    if (!(w > 0)) {
        return 0;
    }
    if (side) {
        return w * (right * a->cosine[bar] - left) * a->csc[bar];
    }
    return w * (right - left * a->cosine[bar]) * a->csc[bar];
}
