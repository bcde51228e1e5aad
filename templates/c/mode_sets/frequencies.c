/* frequencies.c: the dynamic stiffness K of a chain, and its frequencies by counting (Wittrick and Williams 1971).
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "tables.h"

/* A chain with its numbers. Arrays over places have one more entry, which is never read. */
typedef struct {
    real delay[BARS + 1];
    real impedance[BARS + 1];
    real mass[PLACES + 1];
    real held[PLACES + 1];
    real across[PLACES + 1];
    real link[LINKS + 1];
} chain;

static void chain_of(const real *value, chain *c)
{
    for (int place = 0; place <= PLACES; ++place) {
        c->mass[place] = place < PLACES ? value[MASS + place] : 0;
        c->held[place] = place < PLACES ? value[SPRING + place] : 0;
        c->across[place] = 0;
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real k = value[ROD_STIFFNESS + bar_rod[bar]];
        const real m = value[ROD_MASS + bar_rod[bar]];
        c->delay[bar] = bar_part[bar] * sqrt(m / k);
        c->impedance[bar] = sqrt(m * k);
    }
    for (int link = 0; link < LINKS; ++link) {
        const real k = value[LINK + link];
        c->link[link] = k;
        c->held[link_left[link]] += link_ratio[link] * link_ratio[link] * k;
        c->held[link_right[link]] += k;
        c->across[link_up[link]] -= link_ratio[link] * k;
    }
}

/* The diagonal of K and what couples each row to its parent, from w^2 and what each bar, were its impedance 1, adds at
 * its ends, and across. */
static void assemble(
    const chain *c, real square, const real *pulled, const real *shared, real *diagonal, real *up)
{
    for (int place = 0; place <= PLACES; ++place) {
        diagonal[place] = c->held[place] - square * c->mass[place];
        up[place] = c->across[place];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real left = bar_left_ratio[bar];
        const real right = bar_right_ratio[bar];
        const real z = c->impedance[bar];
        diagonal[bar_left[bar]] += left * left * z * pulled[bar];
        diagonal[bar_right[bar]] += right * right * z * pulled[bar];
        up[bar_up[bar]] += left * right * z * shared[bar];
    }
}

/* The pivots of K, in place of its diagonal, tips first. */
static void eliminate(real *diagonal, const real *up)
{
    for (int row = 0; row < ROWS; ++row) {
        if (parent[row] >= 0) {
            diagonal[parent[row]] -= up[row] * up[row] / diagonal[row];
        }
    }
}

/* How many frequencies lie below w: those of bars whose ends rest, and negative pivots. */
static int count_below(const chain *c, real w)
{
    real pulled[BARS + 1];
    real shared[BARS + 1];
    real pivot[PLACES + 1];
    real up[PLACES + 1];
    int count = 0;
    for (int bar = 0; bar < BARS; ++bar) {
        const real angle = w * c->delay[bar];
        const real sine = sin(angle);
        const real turn = floor(angle / 3.14159265358979323846 + 0.5);
        const int odd = fmod(turn, 2) != 0;
        /* such that the sine has the sign that goes with it */
        count += (int)turn - ((odd ? -sine : sine) < 0);
        pulled[bar] = w * cos(angle) / sine;
        shared[bar] = -w / sine;
    }
    assemble(c, w * w, pulled, shared, pivot, up);
    eliminate(pivot, up);
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
    for (int n = 0; n < FOUND; ++n) {
        for (int times = 0; times < 64; ++times) {
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
