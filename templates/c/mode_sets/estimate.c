/* estimate.c: damping, and what modes that are not found can add to outputs (docs/modes.md).
 * Plain C that stands below the text of oscillators.c in generated files, which have what stands below the first empty line. */
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

static real least_of(real x, real y)
{
    return x < y ? x : y;
}

static real most_of(real x, real y)
{
    return x > y ? x : y;
}

static declines declines_under(const model *m, const damping_rule *rule, real w, int load)
{
    const real least = extreme_ratio(rule, w, 1);
    const real most = extreme_ratio(rule, w, 0);
    const real fade = exp(-least * w * spacing);
    real steep = 0;
    real fading = 0;
    real kinked = 0;
    real sum = 0;
    real slope = 0;
    real together = 0;
    for (int k = 0; k < SAMPLES && k * spacing <= tau_max; ++k) {
        const real next = (load_at(m, load, k + 1) - load_at(m, load, k)) / spacing;
        const real kink = fabs(next - slope) + 2 * DBL_EPSILON * (fabs(next) + fabs(slope));
        sum = sum * fade + kink;
        fading = most_of(fading, sum);
        kinked = most_of(kinked, kink);
        steep = most_of(steep, fabs(next));
        slope = next;
    }
    for (int amplitude = 0; amplitude < AMPLITUDES; ++amplitude) {
        together += amplitude_load[amplitude] == load ? fabs(m->factor[amplitude]) * in_step[amplitude] : 0;
    }
    declines made = {{0, 0, 0}, {3, 2, 1}};
    if (rule->b > 0) {
        const real late = steep * (2 / rule->b + rule->a);
        const real small = least_of(1, least);
        made.size[0] = late / (small * small);
        made.size[1] = 4 * late / rule->b;
        made.size[2] = 4 * steep / rule->b;
        made.power[0] = 4;
        made.power[1] = 4;
        made.power[2] = 2;
        return made;
    }
    const real faded = fading > 2 * kinked ? least_of(fading, 2 * together) : fading;
    const real swing = most < 1 ? (most > 0 ? faded : together) / sqrt(1 - most * most) : HUGE_VAL;
    const real crept = least > 0 ? steep / least : HUGE_VAL;
    made.size[0] = least_of(swing + 2 * most * steep, most_of(2 * crept, 2 * most * steep));
    made.size[1] = steep + swing;
    if (least > 0) {
        made.size[1] = least_of(steep + swing, least < 1 ? crept : steep);
    }
    made.size[2] = least_of(swing, 2 * crept);
    return made;
}

/* About how wrong an output is, relative to its largest value, as modes are: a frequency that is a little wrong is so for
 * as long as its mode remembers, and a shape has some of its neighbours'. */
static real looseness(const model *m, const projection *p, int output)
{
    real largest = 0;
    real total = 0;
    for (int n = 0; n < FOUND; ++n) {
        const real w = p->w[n];
        const real square = w * w;
        real share = 0;
        real gap = HUGE_VAL;
        if (!(w > 0)) {
            continue;
        }
        if (n > 0) {
            gap = square - p->w[n - 1] * p->w[n - 1];
        }
        if (n + 1 < FOUND) {
            gap = least_of(gap, p->w[n + 1] * p->w[n + 1] - square);
        }
        for (int load = 0; load < LOADS; ++load) {
            share = most_of(share, fabs(p->share[load][n]));
        }
        const int order = output_order[output];
        const real size = share * fabs(p->output[output][n]) / (order == 2 ? 1 : order == 1 ? w : square);
        const real decay = m->damping[n] * w;
        const real kept = decay * tau_max > 1 ? 1 / decay : tau_max;
        largest = most_of(largest, size);
        if (size > 0) {
            total += size * (p->wrong[n] / (2 * w) * kept + p->wrong[n] / gap + p->blurred[n]);
        }
    }
    return largest > 0 ? total / largest : 0;
}

/* About the largest error of an output whose largest value is this. */
static real error_of(
    const model *m, const projection *p, const damping_rule *rule, const declines *fall, int output, real largest)
{
    const real w = p->w[FOUND - 1] * (1 - DBL_EPSILON);
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
            error += fabs(rest_of(p, output, load)) * size / (64 * w * w);
        }
    }
    error *= 1 + 1e-12;
    return error + (32 * DBL_EPSILON * sqrt((real)SAMPLES) + looseness(m, p, output)) * largest;
}
