/* build.c: a model of parameters. */
#include "steps.c"

static void weights_of(model *m, const projection *p, const damping_rule *rule)
{
    const real above_all = 8 * p->w[FOUND - 1];
    for (int n = 0; n < MODES; ++n) {
        const real w = n < FOUND ? p->w[n] : above_all;
        m->frequency[n] = w;
        m->damping[n] = ratio_at(rule, w, n - FREE);
        for (int load = 0; load < LOADS; ++load) {
            m->push[load][n] = n < FOUND ? p->share[load][n].value : n - FOUND == load ? above_all * above_all : 0;
        }
    }
    for (int output = 0; output < FILLED; ++output) {
        const int counts = output < OUTPUTS && !is_zero[output];
        const int order = counts ? output_order[output] : 0;
        for (int load = 0; load < LOADS; ++load) {
            const real rest = counts && order < 2 ? rest_of(p, output, load).value : 0;
            for (int k = 0; k < 3; ++k) {
                m->direct[load][k][output] = counts && k == 2 - order ? p->imposed[output][load].value : 0;
            }
            for (int n = 0; order == 2 && n < FOUND; ++n) {
                m->direct[load][0][output] += p->output[output][n].value * p->share[load][n].value;
            }
            if (MODES == FOUND && counts && order == 0) {
                m->direct[load][0][output] += rest;
            }
            if (MODES > FOUND) {
                m->moved[FOUND + load][output] = order == 0 ? rest : 0;
                m->moving[FOUND + load][output] = order == 1 ? rest : 0;
            }
        }
        for (int n = 0; n < FOUND; ++n) {
            const real w = p->w[n];
            const real value = counts ? p->output[output][n].value : 0;
            m->moved[n][output] = order == 0 ? value : order == 2 ? -w * w * value : 0;
            m->moving[n][output] = order == 1 ? value : order == 2 ? -2 * m->damping[n] * w * value : 0;
        }
    }
}

/* A block of steps from the first motion on: motions where each begins, and values at the ends of so many halves of steps. */
static void step_block(const model *m, int first, int halves, motion *begin, real (*values)[FILLED])
{
    motion middle[BLOCK];
    const motion *seen[TOGETHER];
    real *out[TOGETHER];
    real slope[LOADS];
    for (int k = 0; k < BLOCK; ++k) {
        slopes_after(m, first + k, slope);
        advance(m, &m->half, spacing / 2, slope, &begin[k], &middle[k]);
        advance(m, &m->half, spacing / 2, slope, &middle[k], &begin[k + 1]);
    }
    for (int half = 0; half < halves; half += TOGETHER) {
        for (int k = 0; k < TOGETHER; ++k) {
            int at_half = half + k;
            LOADED_HERE(at_half);
            seen[k] = at_half % 2 ? &begin[at_half / 2 + 1] : &middle[at_half / 2];
            out[k] = values[at_half];
        }
        read_together(m, seen, out);
    }
}

/* The largest values at the ends and in the middle of steps, where they are larger than `largest`. */
static void largest_values(const model *m, real *largest)
{
    motion begin[BLOCK + 1];
    real values[2 * BLOCK][FILLED];
    rest(&begin[0]);
    for (int first = 0; 2 * first < HALVES; first += BLOCK) {
        const int halves = HALVES - 2 * first < 2 * BLOCK ? HALVES - 2 * first : 2 * BLOCK;
        step_block(m, first, halves, begin, values);
        begin[0] = begin[BLOCK];
        for (int half = 0; half < halves; ++half) {
            for (int output = 0; output < OUTPUTS; ++output) {
                const real size = fabs(values[half][output]);
                largest[output] = size > largest[output] || size != size ? size : largest[output];
            }
        }
    }
}

/* The worst error relative to its output's largest value; what is lost by rounding of each output. */
static real estimate_of(
    const model *m, const projection *p, const damping_rule *rule, const real *largest, real *rounded)
{
    declines fall[LOADS];
    history f[LOADS];
    real worst = 0;
    for (int load = 0; load < LOADS; ++load) {
        f[load] = history_of(m, load, extreme_ratio(rule, p->w[FOUND - 1], 1) * p->w[FOUND - 1]);
        fall[load] = declines_under(m, rule, p->w[FOUND - 1], load, &f[load]);
    }
    rounding_errors(m, p, f, rounded);
    for (int output = 0; output < OUTPUTS; ++output) {
        const real error = rounded[output] + truncation_error(p, rule, fall, output);
        const real relative = error == 0 ? 0 : error < largest[output] ? error / (largest[output] - error) : HUGE_VAL;
        worst = most_of(worst, relative);
    }
    return worst;
}

/* Find modes and what they make of loads and outputs. False for a bad number. */
static BY_ITSELF int find_model(model *m, const name_parameters *parameters, projection *p, damping_rule *rule)
{
    real value[VALUES];
    chain c;
    springs s;
    m->status = 1;
    m->estimate = not_a_number();
    if (!values_of(parameters, value)) {
        return 0;
    }
    for (int amplitude = 0; amplitude < AMPLITUDES; ++amplitude) {
        m->factor[amplitude] = value[FACTOR + amplitude];
    }
    chain_of(value, &c);
    springs_of(&c, &s);
    p->complete = is_complete(&c);
    project_modes(&c, &s, p);
    project_loads(&c, &s, p);
    project_outputs(&c, &s, p);
    *rule = damping_of(value, p);
    weights_of(m, p, rule);
    turns_of(m->frequency, m->damping, spacing / 2, &m->half);
    return 1;
}

/* Say how wrong a model is whose outputs have these largest values. */
static int judge(model *m, const projection *p, const damping_rule *rule, const real *largest, real *rounded)
{
    m->estimate = estimate_of(m, p, rule, largest, rounded);
    m->status = m->estimate <= tolerance ? 0 : 2;
    return m->status;
}

/* 0; 1 for a bad number; 2 where modes are too few for the tolerance, or not known well enough. */
static int build(model *m, const name_parameters *parameters)
{
    projection p;
    damping_rule rule;
    real largest[OUTPUTS] = {0};
    real rounded[OUTPUTS];
    if (!find_model(m, parameters, &p, &rule)) {
        return 1;
    }
    largest_values(m, largest);
    return judge(m, &p, &rule, largest, rounded);
}
