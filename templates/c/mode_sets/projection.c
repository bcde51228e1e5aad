/* projection.c: what modes are of outputs and loads, and their sums over all modes. */
#include "statics.c"

/* By mode: frequencies, how wrong w^2 is, what outputs are of modes, and their shares in loads. What outputs are of the
 * shape that a load imposes, and under one that does not change; sums of squares over all modes, of loads over w^2 where
 * they are forces. What is `lost` of each of them by rounding. Whether modes are all that there are. */
typedef struct {
    real w[FOUND];
    real wrong[FOUND];
    real output[OUTPUTS][FOUND];
    real output_lost[OUTPUTS][FOUND];
    real share[LOADS][FOUND];
    real share_lost[LOADS][FOUND];
    real imposed[OUTPUTS][LOADS];
    real imposed_lost[OUTPUTS][LOADS];
    real settled[OUTPUTS][LOADS];
    real settled_lost[OUTPUTS][LOADS];
    real output_total[OUTPUTS];
    real load_total[LOADS];
    int complete;
} projection;

/* A sum and what its additions have lost. */
typedef struct {
    real sum;
    real lost;
} long_sum;

static void add(long_sum *total, real x)
{
    const volatile real sum = total->sum + x;
    const volatile real part = sum - total->sum;
    const volatile real rest = sum - part;
    total->lost += (total->sum - rest) + (x - part);
    total->sum = sum;
}

/* What an output is of a shape: of how far places move, or of the slope at the end of its bar. */
static real output_value(const chain *c, int output, const real *moved, real slope)
{
    const int bar = output_bar[output];
    real total = 0;
    if (bar >= 0) {
        return output_scale[output] * (output_force[output] ? c->impedance[bar] : c->delay[bar]) * slope;
    }
    for (int term = first_term[output]; term < first_term[output + 1]; ++term) {
        total += term_weight[term] * moved[term_place[term]];
    }
    return total;
}

/* The same of sizes, none of which cancels another. */
static real output_size(const chain *c, int output, const real *size, real slope)
{
    real total = fabs(output_bar[output] < 0 ? 0 : output_value(c, output, size, slope));
    for (int term = first_term[output]; term < first_term[output + 1]; ++term) {
        total += fabs(term_weight[term] * size[term_place[term]]);
    }
    return total;
}

static real value_of_mode(const chain *c, const angles *a, real w, int output, const real *moved, real *lost)
{
    const int bar = output_bar[output];
    real size = 0;
    const real slope = bar < 0 ? 0 : slope_of_mode(a, w, moved, bar, output_side[output], &size);
    *lost = rounding * output_size(c, output, moved, size);
    return output_value(c, output, moved, slope);
}

static real value_of_shape(const chain *c, int output, const real *moved, const real *bent)
{
    const int bar = output_bar[output];
    const real slope = bar < 0 ? 0 : slope_of_shape(c, moved, bent, bar, output_side[output]);
    return output_value(c, output, moved, slope);
}

/* What it may lose of such a value, by how far places move when nothing cancels. */
static real lost_of_shape(const chain *c, int output, const real *size, const real *bent)
{
    const int bar = output_bar[output];
    real slope = 0;
    if (bar >= 0) {
        const real t = c->delay[bar];
        slope = (fabs(end_of(size, bar, 0)) + fabs(end_of(size, bar, 1))) / t;
        slope += t * (fabs(end_of(bent, bar, 0)) + fabs(end_of(bent, bar, 1)));
    }
    return rounding * output_size(c, output, size, slope);
}

/* The share of a mode in a load. */
static real share_of(const chain *c, const angles *a, real w, int load, const real *moved, real *lost)
{
    const int place = load_place[load];
    real pull = 0;
    real size = 0;
    real slope;
    if (place < ROWS) {
        *lost = rounding * fabs(moved[place] * load_gain[load]);
        return moved[place] * load_gain[load];
    }
    /* what holds the end in the mode, over w^2, is the mass that both move together: the mode and what the end imposes */
    for (int bar = 0; bar < BARS; ++bar) {
        if (bar_left[bar] == place) {
            const real part = c->impedance[bar] * bar_left_ratio[bar];
            pull += slope_of_mode(a, w, moved, bar, 0, &slope) * part;
            size += fabs(slope * part);
        }
        if (bar_right[bar] == place) {
            const real part = c->impedance[bar] * bar_right_ratio[bar];
            pull -= slope_of_mode(a, w, moved, bar, 1, &slope) * part;
            size += fabs(slope * part);
        }
    }
    for (int link = 0; link < LINKS; ++link) {
        const real k = link_ratio[link] * c->link[link];
        const real left = link_left[link] == place ? moved[link_right[link]] * k : 0;
        const real right = link_right[link] == place ? moved[link_left[link]] * k : 0;
        pull += left + right;
        size += fabs(left) + fabs(right);
    }
    *lost = rounding * size * fabs(load_gain[load]) / (w * w);
    return -pull * load_gain[load] / (w * w);
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
    real lost[OUTPUTS + LOADS];
    for (int n = 0; n < FOUND; ++n) {
        for (int k = 0; k < OUTPUTS + LOADS; ++k) {
            lost[k] = 0;
        }
        for (int other = 0; other < FOUND; ++other) {
            if (other != n) {
                const real part = part_of_other(p, reach[n], n, other);
                const real square = p->w[other] * p->w[other];
                for (int output = 0; output < OUTPUTS; ++output) {
                    lost[output] += part * fabs(p->output[output][other]);
                }
                for (int load = 0; load < LOADS; ++load) {
                    /* of an end it is a force, which is w^2 times the share */
                    const real pull = load_place[load] < ROWS ? 1 : square / (p->w[n] * p->w[n]);
                    lost[OUTPUTS + load] += part * pull * fabs(p->share[load][other]);
                }
            }
        }
        for (int output = 0; output < OUTPUTS; ++output) {
            p->output_lost[output][n] += lost[output];
        }
        for (int load = 0; load < LOADS; ++load) {
            p->share_lost[load][n] += lost[OUTPUTS + load];
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
            real lost;
            const real value = value_of_mode(c, &a, w, output, found.moved, &lost);
            p->output[output][n] = value;
            p->output_lost[output][n] = lost + found.blurred * fabs(value);
        }
        for (int load = 0; load < LOADS; ++load) {
            real lost;
            const real share = share_of(c, &a, w, load, found.moved, &lost);
            const real square = load_place[load] < ROWS ? 0 : found.wrong / (w * w);
            p->share[load][n] = share;
            p->share_lost[load][n] = lost + (found.blurred + square) * fabs(share);
        }
    }
    mix_modes(p, reach);
}

/* What an output is of the shape that a load imposes: 0 where it is that but for rounding, as of a drift. */
static real imposed_value(const chain *c, int output, const real *imposed, const real *still, real *lost)
{
    const real value = value_of_shape(c, output, imposed, still);
    const real size = lost_of_shape(c, output, imposed, still);
    *lost = fabs(value) > size ? size : 0;
    return fabs(value) > size ? value : 0;
}

static void project_loads(const chain *c, const springs *s, projection *p)
{
    for (int load = 0; load < LOADS; ++load) {
        const int place = load_place[load];
        const real gain = load_gain[load];
        real none[PLACES];
        real force[PLACES];
        real imposed[PLACES];
        real moved[PLACES];
        real bent[PLACES];
        real size[PLACES];
        for (int other = 0; other < PLACES; ++other) {
            none[other] = 0;
            force[other] = other == place;
        }
        if (place < ROWS) {
            loaded_shape(c, s, force, moved, bent, size);
            p->load_total[load] = (moved[place] + rounding * size[place]) * gain * gain;
        } else {
            imposed_shape(c, s, place, imposed);
            inertia(c, imposed, force);
            for (int other = 0; other < PLACES; ++other) {
                force[other] = -force[other];
                bent[other] = imposed[other];
            }
            solve(s, force, 0, moved);
            solve(s, force, 1, size);
            p->load_total[load] = linear_mass(c, imposed, -1, 0, 0) * gain * gain;
        }
        for (int output = 0; output < OUTPUTS; ++output) {
            p->settled[output][load] = value_of_shape(c, output, moved, bent) * gain;
            p->settled_lost[output][load] = lost_of_shape(c, output, size, bent) * fabs(gain);
            p->imposed[output][load] = 0;
            p->imposed_lost[output][load] = 0;
            if (place >= ROWS) {
                real lost;
                p->imposed[output][load] = imposed_value(c, output, imposed, none, &lost) * gain;
                p->imposed_lost[output][load] = lost * fabs(gain);
            }
        }
    }
}

/* The sums over all modes of the squares of outputs, over w^(2 power): not less than they are. */
static void project_outputs(const chain *c, const springs *s, projection *p)
{
    for (int output = 0; output < OUTPUTS; ++output) {
        const int bar = output_bar[output];
        real force[PLACES];
        real moved[PLACES];
        real bent[PLACES];
        real size[PLACES];
        real total = 0;
        real part = 0;
        real lost = 0;
        for (int place = 0; place < PLACES; ++place) {
            force[place] = 0;
        }
        for (int term = first_term[output]; term < first_term[output + 1]; ++term) {
            const int place = term_place[term];
            force[place] += term_weight[term];
            part += term_weight[term] * s->still[place];
            total += c->mass[place] > 0 ? term_weight[term] * term_weight[term] / c->mass[place] : 0;
        }
        if (bar >= 0) {
            const real weight = output_value(c, output, force, 1);
            total = break_mass(c, s, bar, output_side[output], &lost) * weight * weight;
            lost *= weight * weight;
        } else if (output_power[output] == 0) {
            total -= part * part;
        } else {
            loaded_shape(c, s, force, moved, bent, size);
            total = value_of_shape(c, output, moved, bent);
            lost = lost_of_shape(c, output, size, bent);
        }
        p->output_total[output] = total + lost;
    }
}

/* What is left of a sum over all modes without those that are found, and what its roundings may be. */
static real left_over(const projection *p, const real *row, const real *row_lost, int power, real total)
{
    const real spare = (1 + 1e-12) * total;
    long_sum left = {spare, 0};
    real lost = rounding * spare;
    if (p->complete) {
        return 0;
    }
    for (int n = 0; n < FOUND; ++n) {
        const real w = p->w[n];
        if (w > 0) {
            const real unit = power == 2 ? w * w * w * w : power == 1 ? w * w : 1;
            add(&left, -row[n] * row[n] / unit);
            lost += 2 * fabs(row[n]) * row_lost[n] / unit;
            lost += 2 * row[n] * row[n] / unit * p->wrong[n] / (w * w);
        }
    }
    left.sum += left.lost;
    return (left.sum > 0 ? left.sum : 0) + lost;
}

/* What the modes that are not found do to an output under a load that does not change, and what is `lost` of it. */
static real rest_of(const projection *p, int output, int load, real *lost)
{
    long_sum rest = {p->settled[output][load], 0};
    *lost = 0;
    if (p->complete) {
        return 0;
    }
    *lost = p->settled_lost[output][load];
    for (int n = 0; n < FOUND; ++n) {
        const real square = p->w[n] * p->w[n];
        if (square > 0) {
            const real value = fabs(p->output[output][n]);
            const real share = fabs(p->share[load][n]);
            add(&rest, -p->output[output][n] * (p->share[load][n] / square));
            *lost += (p->output_lost[output][n] * share + value * p->share_lost[load][n]) / square;
            *lost += value * share / square * (p->wrong[n] / square + rounding);
        }
    }
    return rest.sum + rest.lost;
}
