/* statics.c: the shapes of loads that do not change, and by them sums over all modes (docs/modes.md). */
#include "shapes.c"

/* K where nothing moves, eliminated, and the motion without strain, of mass 1; 0 where the chain is held. */
typedef struct {
    bonds bond;
    real pivot[ROWS];
    real still[PLACES + 1];
} springs;

/* How far places move, the accelerations by which bars are `bent`, and how far places would move if nothing cancelled: by
 * rounding a shape is wrong by no more than `rounding` times its `size`, as no pivot is a difference. */
typedef struct {
    real moved[PLACES];
    real bent[PLACES];
    real size[PLACES];
} static_shape;

/* How far the end of a bar moves. */
static real end_of(const real *moved, int bar, int side)
{
    return side ? bar_right_ratio[bar] * moved[bar_right[bar]] : bar_left_ratio[bar] * moved[bar_left[bar]];
}

/* The mass of a shape that is linear along bars; the end of one of them moves by `gap` more. */
static real linear_mass(const chain *c, const real *moved, int broken, int side, real gap)
{
    real total = 0;
    for (int place = 0; place < PLACES; ++place) {
        total += c->mass[place] * moved[place] * moved[place];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real left = end_of(moved, bar, 0) + (bar == broken && !side ? gap : 0);
        const real right = end_of(moved, bar, 1) + (bar == broken && side ? gap : 0);
        total += c->impedance[bar] * c->delay[bar] / 3 * (left * left + left * right + right * right);
    }
    return total;
}

static void springs_of(const chain *c, springs *s)
{
    bar_bonds bars;
    real held[ROWS];
    for (int bar = 0; bar < BARS; ++bar) {
        bars.spring[bar] = 1 / c->delay[bar];
        bars.hold[bar] = 0;
        bars.against[bar] = 1;
    }
    assemble(c, 0, &bars, &s->bond);
    eliminate(&s->bond, held, s->pivot);
    const real scale = FREE ? 1 / sqrt(linear_mass(c, rigid, -1, 0, 0)) : 0;
    for (int place = 0; place < PLACES; ++place) {
        s->still[place] = FREE ? scale * rigid[place] : 0;
    }
}

/* How far places move under forces. Where nothing holds the chain forces balance, and its root does not move. With `sizes`
 * all that is added is taken as positive, so that nothing cancels. */
static void substitute(const springs *s, const real *force, int sizes, real *moved)
{
    const bonds *const b = &s->bond;
    for (int place = 0; place < PLACES; ++place) {
        moved[place] = place < ROWS ? (sizes ? fabs(force[place]) : force[place]) : 0;
    }
    for (int row = 0; row < ROWS; ++row) {
        if (parent[row] >= 0) {
            moved[parent[row]] += (sizes ? fabs(b->across[row]) : b->across[row]) * moved[row] / s->pivot[row];
        }
    }
    for (int row = ROWS - 1; row >= 0; --row) {
        if (parent[row] >= 0) {
            const real across = sizes ? fabs(b->across[row]) : b->across[row];
            moved[row] = (moved[row] + across * moved[parent[row]]) / s->pivot[row];
        } else {
            moved[row] = FREE ? 0 : moved[row] / s->pivot[row];
        }
    }
}

/* The forces that accelerate everything as places move. */
static void inertia(const chain *c, const real *moved, real *force)
{
    for (int place = 0; place < PLACES; ++place) {
        force[place] = c->mass[place] * moved[place];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real share = c->impedance[bar] * c->delay[bar] / 6;
        const real left = end_of(moved, bar, 0);
        const real right = end_of(moved, bar, 1);
        force[bar_left[bar]] += share * bar_left_ratio[bar] * (2 * left + right);
        force[bar_right[bar]] += share * bar_right_ratio[bar] * (left + 2 * right);
    }
}

/* The work of forces as the chain moves without strain; `sizes` as above. */
static real along(const springs *s, const real *force, int sizes)
{
    real total = 0;
    for (int place = 0; place < PLACES; ++place) {
        const real part = force[place] * s->still[place];
        total += sizes ? fabs(part) : part;
    }
    return total;
}

/* The shape under forces: where nothing holds the chain they accelerate it, and the shape has no part in that. */
static void loaded_shape(const chain *c, const springs *s, const real *force, static_shape *of)
{
    real acting[PLACES];
    real pull[PLACES];
    const real part = along(s, force, 0);
    for (int place = 0; place < PLACES; ++place) {
        of->bent[place] = part * s->still[place];
    }
    inertia(c, of->bent, pull);
    for (int place = 0; place < PLACES; ++place) {
        acting[place] = force[place] - pull[place];
    }
    substitute(s, acting, 0, of->moved);
    for (int place = 0; place < PLACES; ++place) {
        acting[place] = fabs(force[place]) + fabs(pull[place]);
    }
    substitute(s, acting, 1, of->size);
    inertia(c, of->size, pull);
    const real sizes = along(s, pull, 1);
    inertia(c, of->moved, pull);
    real left = along(s, pull, 0);
    for (int bar = 0; bar < BARS; ++bar) {
        const real t = c->delay[bar];
        left -= end_of(s->still, bar, 0) * end_of(of->bent, bar, 0) * c->impedance[bar] * t * t * t / 12;
    }
    for (int place = 0; place < PLACES; ++place) {
        of->moved[place] -= left * s->still[place];
        of->size[place] += sizes * fabs(s->still[place]);
    }
}

/* The shape that the unit motion of a place imposes: forces of one sign, of which no sum loses digits. */
static void imposed_shape(const chain *c, const springs *s, int place, static_shape *of)
{
    real force[PLACES] = {0};
    for (int bar = 0; bar < BARS; ++bar) {
        const real k = c->impedance[bar] / c->delay[bar] * bar_left_ratio[bar] * bar_right_ratio[bar];
        if (bar_left[bar] == place) {
            force[bar_right[bar]] += k;
        }
        if (bar_right[bar] == place) {
            force[bar_left[bar]] += k;
        }
    }
    for (int link = 0; link < LINKS; ++link) {
        const real k = c->link[link] * link_ratio[link];
        if (link_left[link] == place) {
            force[link_right[link]] += k;
        }
        if (link_right[link] == place) {
            force[link_left[link]] += k;
        }
    }
    substitute(s, force, 0, of->moved);
    of->moved[place] = 1;
    for (int other = 0; other < PLACES; ++other) {
        of->size[other] = of->moved[other];
        of->bent[other] = 0;
    }
}

/* The shape that lags behind an imposed one when that has the acceleration 1. */
static void lagging_shape(const chain *c, const springs *s, const static_shape *imposed, static_shape *of)
{
    real force[PLACES];
    inertia(c, imposed->moved, force);
    for (int place = 0; place < PLACES; ++place) {
        force[place] = -force[place];
        of->bent[place] = imposed->moved[place];
    }
    substitute(s, force, 0, of->moved);
    substitute(s, force, 1, of->size);
}

/* The strain at the end of a bar, times its speed, in a shape. */
static inexact slope_of_shape(const chain *c, const static_shape *of, int bar, int side)
{
    const real t = c->delay[bar];
    const real here = end_of(of->bent, bar, side);
    const real there = end_of(of->bent, bar, !side);
    const real pull = t * (2 * here + there) / 6;
    const real size = (fabs(end_of(of->size, bar, 0)) + fabs(end_of(of->size, bar, 1))) / t;
    inexact slope = {(end_of(of->moved, bar, 1) - end_of(of->moved, bar, 0)) / t + (side ? pull : -pull), 0};
    slope.lost = rounding * (size + t * (fabs(here) + fabs(there)));
    return slope;
}

/* The sum of the squares of the slope at the end of a bar over w^4, of all modes. */
static inexact break_mass(const chain *c, const springs *s, int bar, int side)
{
    real force[PLACES] = {0};
    static_shape of;
    const real gap = (side ? -1 : 1) / c->impedance[bar];
    force[bar_left[bar]] -= bar_left_ratio[bar] / c->delay[bar];
    force[bar_right[bar]] += bar_right_ratio[bar] / c->delay[bar];
    substitute(s, force, 0, of.moved);
    substitute(s, force, 1, of.size);
    inertia(c, of.moved, force);
    const real part =
        along(s, force, 0) + end_of(s->still, bar, side) * gap * c->impedance[bar] * c->delay[bar] / 2;
    inexact mass = {linear_mass(c, of.moved, bar, side, gap) - part * part, 0};
    mass.lost = 2 * rounding * linear_mass(c, of.size, bar, side, fabs(gap));
    return mass;
}
