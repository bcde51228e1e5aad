/* frequencies.c: the dynamic stiffness K of a chain, and its frequencies by counting (Wittrick and Williams 1971). */
#include "tables.h"

static real least_of(real x, real y)
{
    return x < y ? x : y;
}

static real most_of(real x, real y)
{
    return x > y ? x : y;
}

/* A chain with its numbers. Arrays over places have one more entry, which is never read. */
typedef struct {
    real delay[BARS + 1];
    real impedance[BARS + 1];
    real mass[PLACES + 1];
    real held[PLACES + 1];
    real link[LINKS + 1];
} chain;

/* K in parts that are no differences: what holds a row by itself, and the spring to its parent as the row feels it, as the
 * parent does, and across; a bar is a spring and what holds its ends. Sums keep the last digits of soft springs beside
 * stiff ones, which a diagonal of K does not. */
typedef struct {
    real own[PLACES + 1];
    real here[PLACES + 1];
    real there[PLACES + 1];
    real across[PLACES + 1];
} bonds;

/* Of each bar, were its impedance 1: a spring, and what holds its ends. The spring is for what they do against each other
 * (1), or, where the bar is nearer to moving as much at both ends, for what they do alike (-1): at a resonance the other
 * one would be as large as what holds its ends, and cancel it with all that else holds them. */
typedef struct {
    real spring[BARS + 1];
    real hold[BARS + 1];
    real against[BARS + 1];
} bar_bonds;

/* By the sine and cosine of half of w times the delay. */
static void bond_bar(real w, real sine, real cosine, int bar, bar_bonds *of)
{
    of->against[bar] = fabs(sine) <= fabs(cosine) ? 1 : -1;
    of->spring[bar] = of->against[bar] * w / (2 * sine * cosine);
    of->hold[bar] = of->against[bar] > 0 ? -w * sine / cosine : w * cosine / sine;
}

static void chain_of(const real *value, chain *c)
{
    for (int place = 0; place <= PLACES; ++place) {
        c->mass[place] = place < PLACES ? value[MASS + place] : 0;
        c->held[place] = place < PLACES ? value[SPRING + place] : 0;
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real k = value[ROD_STIFFNESS + bar_rod[bar]];
        const real m = value[ROD_MASS + bar_rod[bar]];
        c->delay[bar] = bar_part[bar] * sqrt(m / k);
        c->impedance[bar] = sqrt(m * k);
    }
    for (int link = 0; link < LINKS; ++link) {
        c->link[link] = value[LINK + link];
    }
}

/* Join two places by a spring k for what they do against each other (1) or alike (-1). A row and its parent are coupled,
 * others are at rest and hold the row. */
static void join(bonds *b, int left, real left_ratio, int right, real right_ratio, int row, real k, real against)
{
    const real at_left = left_ratio * left_ratio * k;
    const real at_right = right_ratio * right_ratio * k;
    if (row == PLACES) {
        b->own[left] += at_left;
        b->own[right] += at_right;
        return;
    }
    b->here[row] += row == left ? at_left : at_right;
    b->there[row] += row == left ? at_right : at_left;
    b->across[row] += left_ratio * right_ratio * against * k;
}

/* From w^2 and the bonds of bars. */
static void assemble(const chain *c, real square, const bar_bonds *bars, bonds *b)
{
    for (int place = 0; place <= PLACES; ++place) {
        b->own[place] = c->held[place] - square * c->mass[place];
        b->here[place] = 0;
        b->there[place] = 0;
        b->across[place] = 0;
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const int left = bar_left[bar];
        const int right = bar_right[bar];
        const real left_ratio = bar_left_ratio[bar];
        const real right_ratio = bar_right_ratio[bar];
        const real z = c->impedance[bar];
        b->own[left] += left_ratio * left_ratio * z * bars->hold[bar];
        b->own[right] += right_ratio * right_ratio * z * bars->hold[bar];
        join(b, left, left_ratio, right, right_ratio, bar_up[bar], z * bars->spring[bar], bars->against[bar]);
    }
    for (int link = 0; link < LINKS; ++link) {
        join(b, link_left[link], link_ratio[link], link_right[link], 1, link_up[link], c->link[link], 1);
    }
}

/* A spring and what holds its end: their last digit, where they cancel, as then what is beyond does not move. */
static real pivot_of(real spring, real held)
{
    const real sum = spring + held;
    return sum < 0 || sum > 0 ? sum : DBL_EPSILON * fabs(spring);
}

/* How a spring holds one of its ends, as this feels it, whose other end is held. */
static real through(real here, real there, real held)
{
    return fabs(held) <= DBL_MAX ? here * (held / pivot_of(there, held)) : here;
}

/* What holds each row, once what hangs on it is eliminated, tips first, and its pivot. */
static void eliminate(const bonds *b, real *held, real *pivot)
{
    for (int row = 0; row < ROWS; ++row) {
        held[row] = b->own[row];
    }
    for (int row = 0; row < ROWS; ++row) {
        pivot[row] = parent[row] < 0 ? held[row] : pivot_of(b->here[row], held[row]);
        if (parent[row] >= 0) {
            held[parent[row]] += through(b->there[row], b->here[row], held[row]);
        }
    }
}

/* How many frequencies lie below w: those of bars whose ends rest, and negative pivots. */
static int count_below(const chain *c, real w)
{
    bar_bonds bars;
    real held[ROWS];
    real pivot[ROWS];
    bonds b;
    int count = 0;
    for (int bar = 0; bar < BARS; ++bar) {
        const real half = w * c->delay[bar] / 2;
        const real sine = sin(half);
        const real cosine = cos(half);
        const real turn = floor(2 * half / 3.14159265358979323846 + 0.5);
        const int odd = fmod(turn, 2) != 0;
        /* such that the sine has the sign that goes with it */
        count += (int)turn - ((odd ? -sine : sine) * cosine < 0);
        bond_bar(w, sine, cosine, bar, &bars);
    }
    assemble(c, w * w, &bars, &b);
    eliminate(&b, held, pivot);
    for (int row = 0; row < ROWS; ++row) {
        count += pivot[row] < 0;
    }
    return count;
}

/* Above the n-th frequency, n from 1 on. */
static real above(const chain *c, int n)
{
    real total = 0;
    if (MASSIVE) {
        for (int row = 0; row < ROWS; ++row) {
            total += c->mass[row] > 0 ? c->held[row] / c->mass[row] : 0;
        }
        for (int link = 0; link < LINKS; ++link) {
            const real left = c->mass[link_left[link]];
            const real right = c->mass[link_right[link]];
            total += left > 0 ? link_ratio[link] * link_ratio[link] * c->link[link] / left : 0;
            total += right > 0 ? c->link[link] / right : 0;
        }
        return total > 0 ? 2 * sqrt(total) : 1;
    }
    for (int bar = 0; bar < BARS; ++bar) {
        total += c->delay[bar];
    }
    return (n + BARS) * 3.14159265358979323846 / total;
}

/* The first FOUND frequencies, by bisection; each count is used for all of them. */
static void find_frequencies(const chain *c, real *w)
{
    real low[FOUND];
    for (int n = 0; n < FOUND; ++n) {
        low[n] = 0;
        w[n] = above(c, n + 1);
    }
    for (int n = FREE; n < FOUND; ++n) {
        /* to the last digit: as often as a double has digits, and as the first frequency is below the last */
        for (int times = 0; times < 256; ++times) {
            const real middle = (low[n] + w[n]) / 2;
            if (!(middle > low[n] && middle < w[n])) {
                break;
            }
            const int below = count_below(c, middle);
            for (int other = n; other < FOUND; ++other) {
                if (other < below) {
                    w[other] = middle < w[other] ? middle : w[other];
                } else {
                    low[other] = middle > low[other] ? middle : low[other];
                }
            }
        }
    }
    if (FREE) {
        w[0] = 0;
    }
}
