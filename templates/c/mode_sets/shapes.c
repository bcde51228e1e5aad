/* shapes.c: how far places move in the modes. */
#include "frequencies.c"

/* Of a mode its frequency times each delay; 1/sin of this, sin and cos of half of it. */
typedef struct {
    real angle[BARS + 1];
    real csc[BARS + 1];
    real half_sine[BARS + 1];
    real half_cosine[BARS + 1];
} angles;

/* By rounding each number of K, and what is made of them, is as wrong as one that goes through all rows. */
static const real rounding = (4 * ROWS + 8) * DBL_EPSILON;

static void angles_of(const chain *c, real w, angles *a)
{
    for (int bar = 0; bar < BARS; ++bar) {
        a->angle[bar] = w * c->delay[bar];
        a->half_sine[bar] = sin(a->angle[bar] / 2);
        a->half_cosine[bar] = cos(a->angle[bar] / 2);
        a->csc[bar] = 1 / (2 * a->half_sine[bar] * a->half_cosine[bar]);
    }
}

/* What holds the parent of each row but for the row's own branch. */
static void eliminate_beyond(const bonds *b, const real *held, real *beyond)
{
    for (int row = ROWS - 1; row >= 0; --row) {
        const int on = parent[row];
        beyond[row] = 0;
        if (on < 0) {
            continue;
        }
        beyond[row] = b->own[on];
        for (int other = beside[row]; other != row; other = beside[other]) {
            beyond[row] += through(b->there[other], b->here[other], held[other]);
        }
        if (parent[on] >= 0) {
            beyond[row] += through(b->here[on], b->there[on], beyond[on]);
        }
    }
}

/* Twice the energy of springs that are not negative. */
static real energy(const bonds *b, const real *moved)
{
    real total = 0;
    for (int row = 0; row < ROWS; ++row) {
        total += b->own[row] * moved[row] * moved[row];
        if (parent[row] >= 0 && b->here[row] > 0) {
            const real pull = b->here[row] * moved[row] - b->across[row] * moved[parent[row]];
            total += pull * pull / b->here[row];
        }
    }
    return total;
}

/* 1 - sin(x)/x of an angle and its sine. */
static real lag_of_sine(real x, real sine)
{
    real series = 1;
    if (x > 0.5) {
        return 1 - sine / x;
    }
    for (int k = 8; k > 1; --k) {
        series = 1 - x * x / (2 * k * (2 * k + 1)) * series;
    }
    return x * x / 6 * series;
}

/* A number, and what may be lost of it by rounding. */
typedef struct {
    real value;
    real lost;
} inexact;

/* The mass of a shape, that of bars included: of what both ends do alike, and of what they do against each other; lost is
 * what the rounding of angles makes of it. */
static inexact moved_mass(const chain *c, const angles *a, const real *moved)
{
    inexact total = {0, 0};
    for (int row = 0; row < ROWS; ++row) {
        total.value += c->mass[row] * moved[row] * moved[row];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real x = a->angle[bar];
        const real s = a->half_sine[bar];
        const real k = a->half_cosine[bar];
        const real left = bar_left_ratio[bar] * moved[bar_left[bar]];
        const real right = bar_right_ratio[bar] * moved[bar_right[bar]];
        const real share = c->impedance[bar] * c->delay[bar] / 8;
        const real lag = lag_of_sine(x, 2 * s * k);
        const real alike = share * (2 - lag) * (left + right) * (left + right) / (k * k);
        const real against = share * lag * (right - left) * (right - left) / (s * s);
        total.value += alike + against;
        total.lost += DBL_EPSILON * (alike * (1 + fabs(x * s / k)) + against * (1 + fabs(x * k / s)));
    }
    return total;
}

/* The row, of those that have mass, on which the least is left for each mass once all others are eliminated. */
static int loose_row(const chain *c, const bonds *b, const real *held, const real *beyond, real *weight)
{
    int root = 0;
    real least = -1;
    for (int place = 0; place <= PLACES; ++place) {
        weight[place] = c->mass[place];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real half = c->impedance[bar] * c->delay[bar] / 2;
        weight[bar_left[bar]] += bar_left_ratio[bar] * bar_left_ratio[bar] * half;
        weight[bar_right[bar]] += bar_right_ratio[bar] * bar_right_ratio[bar] * half;
    }
    for (int row = 0; row < ROWS; ++row) {
        const real rest = parent[row] < 0 ? 0 : through(b->here[row], b->there[row], beyond[row]);
        const real left = weight[row] > 0 ? fabs(held[row] + rest) / weight[row] : HUGE_VAL;
        if (left < least || (least < 0 && left >= 0)) {
            least = left;
            root = row;
        }
    }
    return root;
}

/* A mode of mass 1. By rounding w^2 is about as `wrong`; relative to its size the shape is as `blurred`; `reach` says how
 * little of its mass is where it was found. */
typedef struct {
    real moved[PLACES];
    real wrong;
    real blurred;
    real reach;
} shape;

/* The mode with frequency w. K is eliminated from the tips and from the root; in the row on which the least is left a
 * mode needs no force, and from there its shape is what each branch does (Parlett and Dhillon 1997). */
static void find_shape(const chain *c, const angles *a, real w, shape *found)
{
    bar_bonds bars;
    real held[ROWS];
    real pivot[ROWS];
    real beyond[ROWS];
    real weight[PLACES + 1];
    int towards[ROWS] = {0};
    bonds b;
    real *const moved = found->moved;
    for (int bar = 0; bar < BARS; ++bar) {
        bond_bar(w, a->half_sine[bar], a->half_cosine[bar], bar, &bars);
    }
    assemble(c, w * w, &bars, &b);
    eliminate(&b, held, pivot);
    eliminate_beyond(&b, held, beyond);
    for (int place = 0; place < PLACES; ++place) {
        moved[place] = 0;
    }
    const int root = loose_row(c, &b, held, beyond, weight);
    moved[root] = 1;
    towards[root] = 1;
    for (int row = root; parent[row] >= 0; row = parent[row]) {
        moved[parent[row]] = b.across[row] * moved[row] / pivot_of(b.there[row], beyond[row]);
        towards[parent[row]] = 1;
    }
    for (int row = ROWS - 1; row >= 0; --row) {
        if (!towards[row] && parent[row] >= 0) {
            moved[row] = b.across[row] * moved[parent[row]] / pivot[row];
        }
    }
    const inexact mass = moved_mass(c, a, moved);
    const real scale = 1 / sqrt(mass.value);
    for (int row = 0; row < ROWS; ++row) {
        moved[row] *= scale;
    }
    /* points may be nearly at rest between bars that resonate: then the shape is known as well as their angles are */
    found->blurred = mass.lost / mass.value + rounding;
    found->reach = most_of(1, 1 / (sqrt(weight[root]) * fabs(moved[root])));
    /* an angle is as wrong as its last digit: near a resonance of a bar that counts */
    for (int bar = 0; bar < BARS; ++bar) {
        const real grown = 1 + fabs(a->angle[bar] * a->csc[bar]);
        bars.spring[bar] = fabs(bars.spring[bar]) * grown;
        bars.hold[bar] = fabs(bars.hold[bar]) * grown;
    }
    assemble(c, -w * w, &bars, &b);
    found->wrong = rounding * energy(&b, moved);
}

/* The strain at the end of a bar, times its speed, in a mode: it is a difference. */
static inexact slope_of_mode(const angles *a, real w, const real *moved, int bar, int side)
{
    const real left = bar_left_ratio[bar] * moved[bar_left[bar]];
    const real right = bar_right_ratio[bar] * moved[bar_right[bar]];
    const real s = a->half_sine[bar];
    const real k = a->half_cosine[bar];
    const real csc = a->csc[bar];
    const real cosine = (k - s) * (k + s);
    inexact slope = {0, 0};
    if (w > 0) {
        slope.value = side ? w * (right * cosine - left) * csc : w * (right - left * cosine) * csc;
        slope.lost = rounding * fabs(w * csc) * (fabs(left) + fabs(right)) * (1 + fabs(a->angle[bar] * csc));
    }
    return slope;
}
