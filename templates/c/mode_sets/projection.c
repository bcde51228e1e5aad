/* projection.c: what modes are of outputs and loads, and their sums over all modes.
 * Plain C that stands below the text of statics.c in generated files, which have what stands below the first empty line. */
#include "statics.c"

/* By mode: frequencies, how wrong w^2 and how blurred shapes are, what outputs are of modes, and their shares in loads.
 * What outputs are of the shape that a load imposes, and under one that does not change; sums of squares over all modes,
 * of loads over w^2 where they are forces. */
typedef struct {
    real w[FOUND];
    real wrong[FOUND];
    real blurred[FOUND];
    real output[OUTPUTS][FOUND];
    real share[LOADS][FOUND];
    real imposed[OUTPUTS][LOADS];
    real settled[OUTPUTS][LOADS];
    real output_total[OUTPUTS];
    real load_total[LOADS];
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

static real value_of_mode(const chain *c, const angles *a, real w, int output, const real *moved)
{
    const int bar = output_bar[output];
    const real slope = bar < 0 ? 0 : slope_of_mode(c, a, w, moved, bar, output_side[output]);
    return output_value(c, output, moved, slope);
}

static real value_of_shape(const chain *c, int output, const real *moved, const real *bent)
{
    const int bar = output_bar[output];
    const real slope = bar < 0 ? 0 : slope_of_shape(c, moved, bent, bar, output_side[output]);
    return output_value(c, output, moved, slope);
}

/* The share of a mode in a load. */
static real share_of(const chain *c, const angles *a, real w, int load, const real *moved)
{
    const int place = load_place[load];
    real pull = 0;
    if (place < ROWS) {
        return moved[place] * load_gain[load];
    }
    /* what holds the end in the mode, over w^2, is the mass that both move together: the mode and what the end imposes */
    for (int bar = 0; bar < BARS; ++bar) {
        if (bar_left[bar] == place) {
            pull += slope_of_mode(c, a, w, moved, bar, 0) * c->impedance[bar] * bar_left_ratio[bar];
        }
        if (bar_right[bar] == place) {
            pull -= slope_of_mode(c, a, w, moved, bar, 1) * c->impedance[bar] * bar_right_ratio[bar];
        }
    }
    for (int link = 0; link < LINKS; ++link) {
        const real k = link_ratio[link] * c->link[link];
        pull += link_left[link] == place ? moved[link_right[link]] * k : 0;
        pull += link_right[link] == place ? moved[link_left[link]] * k : 0;
    }
    return -pull * load_gain[load] / (w * w);
}

static void project_modes(const chain *c, const springs *s, projection *p)
{
    find_frequencies(c, p->w);
    for (int n = 0; n < FOUND; ++n) {
        const real w = p->w[n];
        real moved[PLACES];
        angles a;
        angles_of(c, w, &a);
        if (FREE && n == 0) {
            p->wrong[n] = 0;
            p->blurred[n] = 0;
            for (int place = 0; place < PLACES; ++place) {
                moved[place] = s->still[place];
            }
        } else {
            find_shape(c, &a, w, moved, &p->wrong[n], &p->blurred[n]);
        }
        for (int output = 0; output < OUTPUTS; ++output) {
            p->output[output][n] = value_of_mode(c, &a, w, output, moved);
        }
        for (int load = 0; load < LOADS; ++load) {
            p->share[load][n] = share_of(c, &a, w, load, moved);
        }
    }
}

/* What an output is of the shape that a load imposes: 0 where it is that but for rounding, as of a drift. */
static real imposed_value(const chain *c, int output, const real *imposed, const real *still)
{
    const real value = value_of_shape(c, output, imposed, still);
    real size = 0;
    if (output_bar[output] >= 0) {
        size = fabs(output_value(c, output, imposed, 1 / c->delay[output_bar[output]]));
    }
    for (int term = first_term[output]; term < first_term[output + 1]; ++term) {
        size += fabs(term_weight[term]);
    }
    return fabs(value) > 1e-12 * size ? value : 0;
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
        for (int other = 0; other < PLACES; ++other) {
            none[other] = 0;
            force[other] = other == place;
        }
        if (place < ROWS) {
            loaded_shape(c, s, force, moved, bent);
            p->load_total[load] = moved[place] * gain * gain;
        } else {
            imposed_shape(c, s, place, imposed);
            inertia(c, imposed, force);
            for (int other = 0; other < PLACES; ++other) {
                force[other] = -force[other];
                bent[other] = imposed[other];
            }
            solve(s, force, moved);
            p->load_total[load] = linear_mass(c, imposed, -1, 0, 0) * gain * gain;
        }
        for (int output = 0; output < OUTPUTS; ++output) {
            p->settled[output][load] = value_of_shape(c, output, moved, bent) * gain;
            p->imposed[output][load] = place < ROWS ? 0 : imposed_value(c, output, imposed, none) * gain;
        }
    }
}

/* The sums over all modes of the squares of outputs, over w^(2 power). */
static void project_outputs(const chain *c, const springs *s, projection *p)
{
    for (int output = 0; output < OUTPUTS; ++output) {
        const int bar = output_bar[output];
        real force[PLACES];
        real moved[PLACES];
        real bent[PLACES];
        real total = 0;
        real part = 0;
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
            total = break_mass(c, s, bar, output_side[output]) * weight * weight;
        } else if (output_power[output] == 0) {
            total -= part * part;
        } else {
            loaded_shape(c, s, force, moved, bent);
            total = value_of_shape(c, output, moved, bent);
        }
        p->output_total[output] = total;
    }
}

/* What is left of a sum over all modes without those that are found, and what its roundings may be. */
static real left_over(const projection *p, const real *row, int power, real total)
{
    const real spare = (1 + 1e-12) * total;
    long_sum left = {spare, 0};
    for (int n = 0; n < FOUND; ++n) {
        const real w = p->w[n];
        if (w > 0) {
            add(&left, -row[n] * row[n] / (power == 2 ? w * w * w * w : power == 1 ? w * w : 1));
        }
    }
    left.sum += left.lost;
    return (left.sum > 0 ? left.sum : 0) + 8 * DBL_EPSILON * spare;
}

/* What the modes that are not found do to an output under a load that does not change. */
static real rest_of(const projection *p, int output, int load)
{
    long_sum rest = {p->settled[output][load], 0};
    for (int n = 0; n < FOUND; ++n) {
        if (p->w[n] > 0) {
            add(&rest, -p->output[output][n] * (p->share[load][n] / p->w[n] / p->w[n]));
        }
    }
    return rest.sum + rest.lost;
}
