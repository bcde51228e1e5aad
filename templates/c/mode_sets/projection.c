/* projection.c: what modes are of outputs and loads, and their sums over all modes. */
#include "statics.c"

/* By mode: frequencies, how wrong w^2 is, what outputs are of modes, and their shares in loads. What outputs are of the
 * shape that a load imposes, and under one that does not change; sums of squares over all modes, of loads over w^2 where
 * they are forces. Whether modes are all that there are. */
typedef struct {
    real w[FOUND];
    real wrong[FOUND];
    inexact output[OUTPUTS][FOUND];
    inexact share[LOADS][FOUND];
    inexact imposed[OUTPUTS][LOADS];
    inexact settled[OUTPUTS][LOADS];
    real output_total[OUTPUTS];
    real load_total[LOADS];
    int complete;
} projection;

/* A sum and what its additions have lost. */
static void add(inexact *total, real x)
{
    const volatile real sum = total->value + x;
    const volatile real part = sum - total->value;
    const volatile real rest = sum - part;
    total->lost += (total->value - rest) + (x - part);
    total->value = sum;
}

/* What an output is: of the slope at the end of its bar, or of how far places move, which by rounding are wrong by no more
 * than `rounding` times `size`. */
static void read_output(const chain *c, int output, const inexact *slope, const real *moved, const real *size, inexact *total)
{
    const int bar = output_bar[output];
    const real scale = bar < 0 ? 0 : output_scale[output] * (output_force[output] ? c->impedance[bar] : c->delay[bar]);
    total->value = scale * slope->value;
    total->lost = fabs(scale) * slope->lost;
    for (int term = first_term[output]; term < first_term[output + 1]; ++term) {
        total->value += term_weight[term] * moved[term_place[term]];
        total->lost += rounding * fabs(term_weight[term] * size[term_place[term]]);
    }
}

static inexact value_of_mode(const chain *c, const angles *a, real w, int output, const real *moved)
{
    const int bar = output_bar[output];
    const inexact none = {0, 0};
    const inexact slope = bar < 0 ? none : slope_of_mode(a, w, moved, bar, output_side[output]);
    inexact total;
    read_output(c, output, &slope, moved, moved, &total);
    return total;
}

static inexact value_of_shape(const chain *c, int output, const static_shape *of)
{
    const int bar = output_bar[output];
    const inexact none = {0, 0};
    const inexact slope = bar < 0 ? none : slope_of_shape(c, of, bar, output_side[output]);
    inexact total;
    read_output(c, output, &slope, of->moved, of->size, &total);
    return total;
}

/* The share of a mode in a load. */
static inexact share_of(const chain *c, const angles *a, real w, int load, const real *moved)
{
    const int place = load_place[load];
    const real gain = load_gain[load];
    inexact pull = {0, 0};
    if (place < ROWS) {
        pull.value = moved[place] * gain;
        pull.lost = rounding * fabs(pull.value);
        return pull;
    }
    /* what holds the end in the mode, over w^2, is the mass that both move together: the mode and what the end imposes */
    for (int bar = 0; bar < BARS; ++bar) {
        for (int side = 0; side < 2; ++side) {
            if ((side ? bar_right[bar] : bar_left[bar]) == place) {
                const real part = c->impedance[bar] * (side ? -bar_right_ratio[bar] : bar_left_ratio[bar]);
                const inexact slope = slope_of_mode(a, w, moved, bar, side);
                pull.value += slope.value * part;
                pull.lost += fabs(slope.lost * part);
            }
        }
    }
    for (int link = 0; link < LINKS; ++link) {
        const real k = link_ratio[link] * c->link[link];
        const real left = link_left[link] == place ? moved[link_right[link]] * k : 0;
        const real right = link_right[link] == place ? moved[link_left[link]] * k : 0;
        pull.value += left + right;
        pull.lost += rounding * (fabs(left) + fabs(right));
    }
    pull.value = -pull.value * gain / (w * w);
    pull.lost *= fabs(gain) / (w * w);
    return pull;
}

/* What a mode has of another one: numbers of K that are a little wrong mix both, by how near they are, and so does a
 * frequency that is. */
static real part_of_other(const projection *p, real reach, int n, int other)
{
    const real apart = fabs(p->w[n] - p->w[other]) * (p->w[n] + p->w[other]);
    const real own = sqrt(p->wrong[n]);
    return own * (sqrt(p->wrong[other]) + (1 + 2 * reach) * own) / (2 * apart);
}

/* Add what modes have of each other, once their values are known. */
static void mix_modes(projection *p, const real *reach)
{
    for (int n = 0; n < FOUND; ++n) {
        for (int other = 0; other < FOUND; ++other) {
            if (other != n) {
                const real part = part_of_other(p, reach[n], n, other);
                const real square = p->w[other] * p->w[other];
                for (int output = 0; output < OUTPUTS; ++output) {
                    p->output[output][n].lost += part * fabs(p->output[output][other].value);
                }
                for (int load = 0; load < LOADS; ++load) {
                    /* of an end it is a force, which is w^2 times the share */
                    const real pull = load_place[load] < ROWS ? 1 : square / (p->w[n] * p->w[n]);
                    p->share[load][n].lost += part * pull * fabs(p->share[load][other].value);
                }
            }
        }
    }
}

/* Whether there are as many modes as masses, and each place has one: then they are all motions. */
static int is_complete(const chain *c)
{
    int heavy = 0;
    for (int row = 0; row < ROWS; ++row) {
        heavy += c->mass[row] > 0;
    }
    return MASSIVE && heavy == ROWS && heavy == FOUND;
}

static void project_modes(const chain *c, const springs *s, projection *p)
{
    real reach[FOUND];
    find_frequencies(c, p->w);
    for (int n = 0; n < FOUND; ++n) {
        const real w = p->w[n];
        shape found = {{0}, 0, 0, 1};
        angles a;
        angles_of(c, w, &a);
        if (FREE && n == 0) {
            for (int place = 0; place < PLACES; ++place) {
                found.moved[place] = s->still[place];
            }
        } else {
            find_shape(c, &a, w, &found);
        }
        p->wrong[n] = found.wrong;
        reach[n] = found.reach;
        for (int output = 0; output < OUTPUTS; ++output) {
            inexact *const value = &p->output[output][n];
            *value = value_of_mode(c, &a, w, output, found.moved);
            value->lost += found.blurred * fabs(value->value);
        }
        for (int load = 0; load < LOADS; ++load) {
            inexact *const share = &p->share[load][n];
            const real square = load_place[load] < ROWS ? 0 : found.wrong / (w * w);
            *share = share_of(c, &a, w, load, found.moved);
            share->lost += (found.blurred + square) * fabs(share->value);
        }
    }
    mix_modes(p, reach);
}

static void project_loads(const chain *c, const springs *s, projection *p)
{
    for (int load = 0; load < LOADS; ++load) {
        const int place = load_place[load];
        const real gain = load_gain[load];
        const int moves = place >= ROWS;
        static_shape imposed;
        static_shape settled;
        if (moves) {
            imposed_shape(c, s, place, &imposed);
            lagging_shape(c, s, &imposed, &settled);
            p->load_total[load] = linear_mass(c, imposed.moved, -1, 0, 0) * gain * gain;
        } else {
            real force[PLACES] = {0};
            force[place] = 1;
            loaded_shape(c, s, force, &settled);
            p->load_total[load] = (settled.moved[place] + rounding * settled.size[place]) * gain * gain;
        }
        for (int output = 0; output < OUTPUTS; ++output) {
            const inexact none = {0, 0};
            const inexact value = value_of_shape(c, output, &settled);
            const inexact given = moves ? value_of_shape(c, output, &imposed) : none;
            /* it may be 0 but for rounding, as of a drift */
            const int counts = fabs(given.value) > given.lost;
            p->settled[output][load].value = value.value * gain;
            p->settled[output][load].lost = value.lost * fabs(gain);
            p->imposed[output][load].value = counts ? given.value * gain : 0;
            p->imposed[output][load].lost = counts ? given.lost * fabs(gain) : 0;
        }
    }
}

/* The sums over all modes of the squares of outputs, over w^(2 power): not less than they are. */
static void project_outputs(const chain *c, const springs *s, projection *p)
{
    for (int output = 0; output < OUTPUTS; ++output) {
        const int bar = output_bar[output];
        real force[PLACES] = {0};
        inexact total = {0, 0};
        real part = 0;
        for (int term = first_term[output]; term < first_term[output + 1]; ++term) {
            const int place = term_place[term];
            force[place] += term_weight[term];
            part += term_weight[term] * s->still[place];
            total.value += c->mass[place] > 0 ? term_weight[term] * term_weight[term] / c->mass[place] : 0;
        }
        if (bar >= 0) {
            const inexact one = {1, 0};
            inexact weight;
            read_output(c, output, &one, force, force, &weight);
            total = break_mass(c, s, bar, output_side[output]);
            total.value *= weight.value * weight.value;
            total.lost *= weight.value * weight.value;
        } else if (output_power[output] == 0) {
            total.value -= part * part;
        } else {
            static_shape loaded;
            loaded_shape(c, s, force, &loaded);
            total = value_of_shape(c, output, &loaded);
        }
        p->output_total[output] = total.value + total.lost;
    }
}

/* What is left of a sum over all modes without those that are found, and what its roundings may be. */
static real left_over(const projection *p, const inexact *row, int power, real total)
{
    const real spare = (1 + 1e-12) * total;
    inexact left = {spare, 0};
    real lost = rounding * spare;
    if (p->complete) {
        return 0;
    }
    for (int n = 0; n < FOUND; ++n) {
        const real w = p->w[n];
        if (w > 0) {
            const real unit = power == 2 ? w * w * w * w : power == 1 ? w * w : 1;
            const real x = row[n].value;
            add(&left, -x * x / unit);
            lost += 2 * fabs(x) * row[n].lost / unit;
            lost += 2 * x * x / unit * p->wrong[n] / (w * w);
        }
    }
    left.value += left.lost;
    return (left.value > 0 ? left.value : 0) + lost;
}

/* What the modes that are not found do to an output under a load that does not change. */
static inexact rest_of(const projection *p, int output, int load)
{
    inexact total = {p->settled[output][load].value, 0};
    inexact rest = {0, 0};
    if (p->complete) {
        return rest;
    }
    rest.lost = p->settled[output][load].lost;
    for (int n = 0; n < FOUND; ++n) {
        const inexact value = p->output[output][n];
        const inexact share = p->share[load][n];
        const real square = p->w[n] * p->w[n];
        if (square > 0) {
            add(&total, -value.value * (share.value / square));
            rest.lost += (value.lost * fabs(share.value) + fabs(value.value) * share.lost) / square;
            rest.lost += fabs(value.value * share.value) / square * (p->wrong[n] / square + rounding);
        }
    }
    rest.value = total.value + total.lost;
    return rest;
}
