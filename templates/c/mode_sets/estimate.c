/* estimate.c: damping, and what modes that are not found can add to outputs (docs/modes.md). */
#include "oscillators.c"

/* The ratios of the first modes with strain, the last one for all higher ones; or a/w + b w, halved, for all. */
typedef struct {
    real ratio[RATIOS];
    real a;
    real b;
} damping_rule;

/* What the modes left out, which have frequencies of at least w, do under a load: a mode with shares l and b adds at most
 * size |l b|/w^power to displacements, velocities and accelerations. */
typedef struct {
    real size[3];
    int power[3];
} declines;

static damping_rule damping_of(const real *value, const projection *p)
{
    damping_rule rule = {{0}, 0, 0};
    for (int k = 0; k < RATIOS; ++k) {
        rule.ratio[k] = value[RATIO + k];
    }
    if (FIRST_MODE > 0) {
        const real first = p->w[FIRST_MODE - 1 + FREE];
        const real second = p->w[SECOND_MODE - 1 + FREE];
        rule.a = 2 * rule.ratio[0] * first * second / (first + second);
        rule.b = 2 * rule.ratio[0] / (first + second);
    }
    return rule;
}

/* The ratio at a frequency, that of the n-th mode with strain. */
static real ratio_at(const damping_rule *rule, real w, int n)
{
    if (!(w > 0)) {
        return 0;
    }
    return rule->b > 0 ? (rule->a / w + rule->b * w) / 2 : rule->ratio[n < RATIOS ? n : RATIOS - 1];
}

/* The largest, or least, ratio of the modes left out. */
static real extreme_ratio(const damping_rule *rule, real w, int least)
{
    const int count = FOUND - FREE;
    if (rule->b > 0) {
        if (!least) {
            return HUGE_VAL;
        }
        return rule->b * w * w < rule->a ? sqrt(rule->a * rule->b) : (rule->a / w + rule->b * w) / 2;
    }
    real found = rule->ratio[RATIOS - 1];
    for (int k = count < RATIOS - 1 ? count : RATIOS - 1; k < RATIOS; ++k) {
        found = (rule->ratio[k] < found) == least && rule->ratio[k] != found ? rule->ratio[k] : found;
    }
    return found;
}

/* The sample of a load. */
static real load_at(const model *m, int load, int k)
{
    real total = 0;
    for (int amplitude = 0; amplitude < AMPLITUDES; ++amplitude) {
        if (amplitude_load[amplitude] == load && k < SAMPLES) {
            total += m->factor[amplitude] * sample[amplitude * SAMPLES + k];
        }
    }
    return total;
}

/* A load of the scene: its largest value, its integral, and how much it and its slope vary; its steepest slope, its
 * largest kink, and the largest of its kinks together, which fade at a rate. */
typedef struct {
    real peak;
    real area;
    real turn;
    real bend;
    real steep;
    real kink;
    real fading;
} history;

static history history_of(const model *m, int load, real rate)
{
    const real fade = exp(-rate * spacing);
    history f = {0, 0, 0, 0, 0, 0, 0};
    real now = 0;
    real slope = 0;
    real sum = 0;
    for (int k = 0; k < SAMPLES && k * spacing <= tau_max; ++k) {
        const real next = load_at(m, load, k + 1);
        const real steep = (next - now) / spacing;
        const real kink = fabs(steep - slope) + 2 * DBL_EPSILON * (fabs(steep) + fabs(slope));
        f.peak = most_of(f.peak, fabs(next));
        f.area += (fabs(now) + fabs(next)) / 2 * spacing;
        f.turn += fabs(next - now);
        f.bend += kink;
        f.steep = most_of(f.steep, fabs(steep));
        f.kink = most_of(f.kink, kink);
        sum = sum * fade + kink;
        f.fading = most_of(f.fading, sum);
        now = next;
        slope = steep;
    }
    return f;
}

static declines declines_under(const model *m, const damping_rule *rule, real w, int load, const history *f)
{
    const real least = extreme_ratio(rule, w, 1);
    const real most = extreme_ratio(rule, w, 0);
    real together = 0;
    for (int amplitude = 0; amplitude < AMPLITUDES; ++amplitude) {
        together += amplitude_load[amplitude] == load ? fabs(m->factor[amplitude]) * in_step[amplitude] : 0;
    }
    if (rule->b > 0) {
        const real late = f->steep * (2 / rule->b + rule->a);
        const real small = least_of(1, least);
        const declines made = {{late / (small * small), 4 * late / rule->b, 4 * f->steep / rule->b}, {4, 4, 2}};
        return made;
    }
    const real faded = f->fading > 2 * f->kink ? least_of(f->fading, 2 * together) : f->fading;
    const real swing = most < 1 ? (most > 0 ? faded : together) / sqrt(1 - most * most) : HUGE_VAL;
    const real crept = least > 0 ? f->steep / least : HUGE_VAL;
    const real steep = 2 * most * f->steep;
    declines made = {{0, f->steep + swing, least_of(swing, 2 * crept)}, {3, 2, 1}};
    made.size[0] = least_of(swing + steep, most_of(2 * crept, steep));
    if (least > 0) {
        made.size[1] = least_of(made.size[1], least < 1 ? crept : f->steep);
    }
    return made;
}

/* The largest displacement and velocity of an oscillator under a load of share 1, and what they lose by rounding; how
 * far it swings about what the load holds it at. */
typedef struct {
    real y;
    real v;
    real y_lost;
    real v_lost;
    real free;
} swing;

/* Under an impulse it moves by h: |h| <= 1/w, |h| <= t and |h'| <= 1, as energy does not grow; the integrals of |h| and
 * |h'| are `far` and `quick`, of a sum over half periods each exp(-pi z) of the one before. Under a load f it moves by
 * the integral of h f, by that of the response to a step, which is at most 2/w^2, times f', and so on; about f/w^2 by h/w^2
 * for each kink of f. */
static swing swing_of(const history *f, real w, real z, real wrong)
{
    const real pi = 3.14159265358979323846;
    const real step = spacing / 2;
    const real steps = HALVES + 1;
    const real slow = w > 0 ? least_of(tau_max, 1 / w) : tau_max;
    const real once = w > 0 ? least_of(step, 1 / w) : step;
    const real loop = z > 0 ? 1 + 2 / (pi * z) : HUGE_VAL;
    real far = tau_max * least_of(tau_max / 2, slow);
    real quick = tau_max;
    real twice = tau_max * tau_max / 2;
    real smooth = HUGE_VAL;
    swing found = {0, 0, 0, 0, 0};
    if (w > 0) {
        far = least_of(far, loop / (w * w));
        quick = least_of(quick, 2 * loop / w);
        twice = least_of(twice, 2 / (w * w));
        smooth = 2 / (w * w) * f->bend;
    }
    found.y = least_of(least_of(f->area * slow, f->peak * far), f->turn * twice);
    found.v = least_of(least_of(f->area, f->peak * quick), least_of(f->turn * slow, smooth));
    found.free = w > 0 ? least_of(found.y + f->peak / (w * w), f->bend / (w * w * w)) : 0;
    /* a frequency that is wrong is a force of what it changes */
    wrong += 8 * DBL_EPSILON * w * w;
    const real force = wrong * (found.y + (w > 0 ? 4 * z / w * found.v : 0)) + steps * DBL_EPSILON * f->peak;
    found.y_lost = force * far;
    found.v_lost = force * quick;
    /* each step adds what it rounds, which is remembered as impulses are */
    const real y_step = 8 * DBL_EPSILON * (found.y + once * found.v + once * once * f->peak);
    const real v_step = 8 * DBL_EPSILON * (found.v + w * w * once * found.y + once * f->peak);
    const real h = least_of(steps * slow, far / step + quick);
    const real h1 = least_of(steps, quick / step + 1 + w * w * far + 2 * z * w * quick);
    found.y_lost += v_step * h + y_step * (h1 + 2 * z * w * h);
    found.v_lost += v_step * h1 + y_step * w * w * h;
    return found;
}

/* What rounding may do to all outputs: to modes, to what they and loads do in steps, and to sums over all modes. */
static BY_ITSELF void rounding_errors(const model *m, const projection *p, const history *f, real *error)
{
    const real sum = (MODES + 3 * LOADS) * DBL_EPSILON;
    const real steps = (HALVES + 1) * DBL_EPSILON;
    for (int output = 0; output < OUTPUTS; ++output) {
        error[output] = 0;
    }
    for (int load = 0; load < LOADS; ++load) {
        for (int n = 0; n < FOUND; ++n) {
            const real w = p->w[n];
            const real z = m->damping[n];
            const swing s = swing_of(&f[load], w, z, p->wrong[n]);
            const real change = 2 * p->wrong[n] * (s.y + (w > 0 ? z / w * s.v : 0));
            const real size[3] = {s.y, s.v, f[load].peak + w * w * s.y + 2 * z * w * s.v};
            const real lost[3] = {
                s.y_lost, s.v_lost, steps * f[load].peak + change + w * w * s.y_lost + 2 * z * w * s.v_lost};
            const real share = fabs(p->share[load][n].value);
            const real all = share + p->share[load][n].lost;
            for (int output = 0; output < OUTPUTS; ++output) {
                const int order = output_order[output];
                const real value = fabs(p->output[output][n].value);
                const real loose = value * p->share[load][n].lost + p->output[output][n].lost * all;
                error[output] += loose * size[order] + value * share * (lost[order] + sum * size[order]);
            }
        }
        for (int output = 0; output < OUTPUTS; ++output) {
            const int order = output_order[output];
            const real grown = order == 2 ? f[load].peak : order == 1 ? f[load].area : f[load].area * tau_max;
            const inexact imposed = p->imposed[output][load];
            error[output] += (imposed.lost + 2 * steps * fabs(imposed.value)) * grown;
            if (order < 2 && !is_zero[output]) {
                const inexact rest = rest_of(p, output, load);
                const real size = order == 0 ? f[load].peak : MODES > FOUND ? f[load].bend : 0;
                error[output] += 2 * (rest.lost + (steps + sum) * fabs(rest.value)) * size;
            }
        }
    }
    for (int output = 0; output < OUTPUTS; ++output) {
        error[output] = is_zero[output] ? 0 : error[output];
    }
}

/* What modes that are not found may add to an output. */
static real truncation_error(const projection *p, const damping_rule *rule, const declines *fall, int output)
{
    const real w = p->w[FOUND - 1] * (1 - rounding);
    const int order = output_order[output];
    const real left = left_over(p, p->output[output], output_power[output], p->output_total[output]);
    real error = 0;
    if (is_zero[output]) {
        return 0;
    }
    for (int load = 0; load < LOADS; ++load) {
        const int power = load_place[load] < ROWS;
        const real other = left_over(p, p->share[load], power, p->load_total[load]);
        const real size = fall[load].size[order];
        const real root = sqrt(left * other);
        /* nothing left out adds nothing */
        error += root > 0 ? root * size * pow(w, output_power[output] + power - fall[load].power[order]) : 0;
        if (rule->b > 0 && order < 2) {
            error += fabs(rest_of(p, output, load).value) * size / (64 * w * w);
        }
    }
    return error * (1 + 1e-12);
}
