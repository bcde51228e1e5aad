/* runtime.c: a march under parameters that come at run time, and its polynomials, one by one and in blocks.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "runtime_tables.h"

/* Loops over a block of samples are unrolled, so that its values stay in registers. */
enum { LEFT = 0, RIGHT = 1, LOAD = 2, RATIO = 0, FIRST = 1, LAST = 2, SLACK = 0, LOSS = 1, LEAK = 2, BLOCK = 16 };

#if defined(__OPTIMIZE_SIZE__)
#define UNROLLED
#elif defined(__clang__)
#define UNROLLED _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#define UNROLLED _Pragma("GCC unroll 16")
#else
#define UNROLLED
#endif

typedef real wave_of[NAME_PANELS][NAME_NODES + 2][NAME_DEGREE + 1];

static real magnitude(real x)
{
    return x < 0 ? -x : x;
}

/* False for what is no number. */
static int finite_number(real x)
{
    return x >= -largest_number && x <= largest_number;
}

/* sum of c_k T_k(u) */
static real series_at(const real *c, int degree, real u)
{
    const real twice = u + u;
    real next = 0;
    real after = 0;
    for (int k = degree; k > 0; --k) {
        const real now = (twice * next - after) + c[k];
        after = next;
        next = now;
    }
    return (u * next - after) + c[0];
}

/* The antiderivative of a series, times 1 / half the length of the panel: all c_k but the first, which is 0. */
static void integrate(const model_of *m, const real *w, int degree, real *c)
{
    c[0] = 0;
    c[1] = w[0] - (degree > 1 ? w[2] / 2 : (real)0);
    for (int k = 2; k < degree; ++k) {
        c[k] = (w[k - 1] - w[k + 1]) * m->inverse[k];
    }
    c[degree] = w[degree - 1] * m->inverse[degree];
    c[degree + 1] = w[degree] * m->inverse[degree + 1];
}

/* The same as series_at, sooner at both ends of a panel and in its middle. */
static real end_value(const real *c, int degree, real u)
{
    real some = 0;
    real others = 0;
    if (u >= 0 && u <= 0) {
        for (int k = 0; k <= degree; k += 4) {
            some += c[k];
            others += k + 2 <= degree ? c[k + 2] : (real)0;
        }
        return some - others;
    }
    if (u > -1 && u < 1) {
        return series_at(c, degree, u);
    }
    for (int k = 0; k <= degree; k += 2) {
        some += c[k];
        others += k + 1 <= degree ? c[k + 1] : (real)0;
    }
    return u < 0 ? some - others : some + others;
}

static int laws_within_reach(const laws *law)
{
    int within = 1;
    for (int node = 0; node < NAME_NODES; ++node) {
        within &= finite_number(law->alpha[node]) && finite_number(law->beta[node]) && finite_number(law->rate[node]) &&
                  finite_number(law->motion[node]);
    }
    for (int node = 0; node <= NAME_NODES; ++node) {
        within &= finite_number(law->rod[node]);
    }
    for (int k = 0; k < STRENGTHS; ++k) {
        within &= finite_number(law->strength[k]);
    }
    for (int k = 0; k < NAME_HEARD; ++k) {
        within &= finite_number(law->gain[k]);
    }
    return within;
}

/* The tables of bodies for polynomials of a degree: the elimination of q_k + x_k (q_(k-1) - q_(k+1)) = x_k (p_(k-1) -
 * p_(k+1)) from the highest k down. Bodies of equal rate on panels of equal length share them. */
static void tabulate(model_of *m, const laws *law, int degree)
{
    for (int k = 1; k <= degree + 1; ++k) {
        m->inverse[k] = 1 / (real)(2 * k);
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int node = 0; node < NAME_NODES; ++node) {
            const int here = panel * NAME_NODES + node;
            const real step = law->rate[node] * (2 * half_length[panel]);
            int row = -1;
            for (int other = 0; other < here && row < 0; ++other) {
                const real known = law->rate[other % NAME_NODES] * (2 * half_length[other / NAME_NODES]);
                row = known <= step && known >= step ? other : -1;
            }
            m->row[here] = row < 0 ? here : row;
            if (row >= 0 || !(law->rate[node] > 0)) {
                continue;
            }
            real *const ratio = m->table[here][RATIO];
            real *const first = m->table[here][FIRST];
            real *const last = m->table[here][LAST];
            ratio[degree + 1] = 0;
            first[degree + 1] = 0;
            last[degree + 1] = 0;
            for (int k = degree; k > 0; --k) {
                ratio[k] = step / ((real)(4 * k) + step * ratio[k + 1]);
                first[k] = (real)(k % 2 ? -1 : 1) - ratio[k + 1] * first[k + 1];
                last[k] = 1 - ratio[k + 1] * last[k + 1];
            }
            const real begun = 2 * ratio[1] * first[1];
            m->edge[here][SLACK] = -begun / (1 - begun);
            m->edge[here][LOSS] = 2 * ratio[1] * last[1];
            m->edge[here][LEAK] = step / (real)(4 * (degree + 1));
        }
    }
}

/* At rest, or as rods move at first; `waves` of both windows. */
static void start_waves(wave_of (*waves)[3], const laws *law, int degree)
{
    for (int half = 0; half < 2; ++half) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            for (int node = 0; node < NAME_NODES + 2; ++node) {
                for (int way = LEFT; way <= LOAD; ++way) {
                    for (int k = 0; k <= degree; ++k) {
                        waves[half][way][panel][node][k] = 0;
                    }
                }
                if (node > 0) {
                    waves[half][LEFT][panel][node][0] = law->rod[node - 1];
                }
                if (node <= NAME_NODES) {
                    waves[half][RIGHT][panel][node][0] = law->rod[node];
                }
            }
        }
    }
}

/* No load, and nothing gathered yet. */
static void start_sums(real *total, real (*load)[3], int (*since)[2])
{
    for (int k = 0; k < NAME_HEARD; ++k) {
        total[k] = 0;
    }
    for (int f = 0; f <= NAME_FORCES; ++f) {
        for (int power = 0; power < 3; ++power) {
            load[f][power] = 0;
        }
        since[f][0] = 0;
        since[f][1] = 0;
    }
}

/* Series of higher degree: what they had not is 0. */
static void lengthen(wave_of (*waves)[3], int degree, int higher)
{
    for (int half = 0; half < 2; ++half) {
        for (int way = LEFT; way <= LOAD; ++way) {
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                for (int node = 0; node < NAME_NODES + 2; ++node) {
                    for (int k = degree + 1; k <= higher; ++k) {
                        waves[half][way][panel][node][k] = 0;
                    }
                }
            }
        }
    }
}

/* The loads on the panels of a window, as series, after their changes there, the first of which is `event`. The first
 * one of the next window. */
static int press(const real *change, real (*load)[3], int (*since)[2], real (*force)[NAME_FORCES + 1][3], int window,
                 int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        while (event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel) {
            const int f = event_force[event];
            real *const c = load[f];
            const real gone = (real)(window - since[f][0]) + since_panel[panel * NAME_PANELS + since[f][1]];
            c[0] += gone * (c[1] + gone * c[2]);
            c[1] += 2 * gone * c[2];
            c[event_power[event]] += change[event];
            since[f][0] = window;
            since[f][1] = panel;
            ++event;
        }
        const real half = half_length[panel];
        for (int f = 0; f < NAME_FORCES; ++f) {
            const real *const c = load[f];
            const real middle = ((real)(window - since[f][0]) + since_panel[panel * NAME_PANELS + since[f][1]]) + half;
            force[panel][f][0] = (c[0] + middle * c[1]) + (middle * middle + half * half / 2) * c[2];
            force[panel][f][1] = half * (c[1] + 2 * middle * c[2]);
            force[panel][f][2] = half * half / 2 * c[2];
        }
    }
    return event;
}

/* The velocity q of a body on a panel; `velocity` goes from its start to its end. What the polynomial misses. */
static real moved(const model_of *m, int row, int degree, const real *p, real *q, real *velocity)
{
    const real *const ratio = m->table[row][RATIO];
    const real *const first = m->table[row][FIRST];
    const real *const last = m->table[row][LAST];
    real y = 0;
    real begun = 0;
    real ended = 0;
    for (int k = degree; k > 0; --k) {
        const real change = (k == 1 ? 2 * p[0] : p[k - 1]) - p[k + 1];
        y = ratio[k] * change + ratio[k] * y;
        q[k] = y;
        begun += first[k] * y;
        ended += last[k] * y;
    }
    begun = *velocity - begun;
    q[0] = begun - m->edge[row][SLACK] * begun;
    *velocity = q[0] + (ended - m->edge[row][LOSS] * q[0]);
    real before = 2 * q[0];
    for (int k = 1; k <= degree; ++k) {
        before = q[k] - ratio[k] * before;
        q[k] = before;
    }
    return m->edge[row][LEAK] * magnitude(q[degree] - p[degree]);
}

static real larger(real one, real other)
{
    return magnitude(other) > one ? magnitude(other) : one;
}

/* One window at a degree, from the waves of the window before in the other half. What its polynomials miss; `size`
 * grows to the largest velocity or mean of a wave. */
static real march(model_of *m, const laws *law, int half, int degree, real *size)
{
    real missed = 0;
    real p[NAME_DEGREE + 2];
    real q[NAME_DEGREE + 1];
    for (int node = 0; node < NAME_NODES; ++node) {
        m->velocity[1][node] = m->velocity[0][node];
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int f = 0; f < NAME_FORCES; ++f) {
            for (int k = 0; k < 3; ++k) {
                m->waves[half][LOAD][panel][f][k] = m->force[panel][f][k];
            }
        }
        for (int node = 0; node < NAME_NODES; ++node) {
            const real *const a = m->waves[!half][RIGHT][panel][node];
            const real *const b = m->waves[!half][LEFT][panel][node + 2];
            real *const left = m->waves[half][LEFT][panel][node + 1];
            real *const right = m->waves[half][RIGHT][panel][node + 1];
            const real alpha = law->alpha[node];
            const real beta = law->beta[node];
            for (int k = 0; k <= degree; ++k) {
                p[k] = alpha * a[k] + beta * b[k];
            }
            p[degree + 1] = 0;
            if (force_on[node] >= 0) {
                for (int k = 0; k < 3; ++k) {
                    p[k] += m->force[panel][force_on[node]][k];
                }
            }
            const real *sent = p;
            if (law->rate[node] > 0) {
                missed += moved(m, m->row[panel * NAME_NODES + node], degree, p, q, &m->velocity[1][node]);
                *size = larger(*size, m->velocity[1][node]);
                sent = q;
            }
            for (int k = 0; k <= degree; ++k) {
                left[k] = sent[k] - a[k];
                right[k] = sent[k] - b[k];
            }
            *size = larger(larger(*size, left[0]), right[0]);
        }
    }
    return missed;
}

static void clear(real *all, int degree)
{
    for (size_t k = 0; k < (size_t)NAME_STRANDS * (size_t)(degree + 2); ++k) {
        all[k] = 0;
    }
}

/* Add to all strands of a window what is heard of waves: each times its gain, or their integrals from tau = 0 on, of
 * which `total` is what windows before have brought. */
static void listen(const model_of *m, wave_of (*waves)[3], const real *gains, real *total, int half, int degree,
                   real *all)
{
    real sum[NAME_DEGREE + 2];
    for (int s = 0; s < NAME_STRANDS; ++s) {
        real *const c = all + (size_t)s * (size_t)(degree + 2);
        for (int t = first_term[s]; t < first_term[s + 1]; ++t) {
            const real *const w = waves[term_back[t] ? !half : half][term_way[t]][term_panel[t]][term_sender[t]];
            const int heard = term_heard[t];
            const real gain = gains[heard];
            if (term_summed[t]) {
                const real length = half_length[term_panel[t]];
                integrate(m, w, degree, sum);
                const real low = length * end_value(sum, degree + 1, term_low[t]);
                c[0] += gain * (total[heard] - low);
                for (int k = 1; k <= degree + 1; ++k) {
                    c[k] += gain * length * sum[k];
                }
                total[heard] += length * end_value(sum, degree + 1, term_high[t]) - low;
            } else {
                for (int k = 0; k <= degree; ++k) {
                    c[k] += gain * w[k];
                }
            }
        }
    }
}

/* Look for the largest mean of each output. */
static void look(model_of *m, const real *all, int degree)
{
    for (int section = 0; section < SECTIONS; ++section) {
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            const int at = section * NAME_OUTPUTS + output;
            real mean = 0;
            for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
                mean += all[(size_t)strand_at[k] * (size_t)(degree + 2)];
            }
            m->largest[output] = larger(m->largest[output], mean);
        }
    }
}

/* One window of the derivatives by a parameter, of which `slope` is what the laws change by. With q'/rate + q = p,
 *
 *     dq'/rate + dq = dp + drate/rate (p - q). */
static void follow(name_tangent *tangent, const laws *law, const laws *slope, int lane, int half, int degree)
{
    const model_of *const m = &tangent->value;
    wave_of(*const waves)[3] = tangent->waves[lane];
    real p[NAME_DEGREE + 2];
    real q[NAME_DEGREE + 1];
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int f = 0; f < NAME_FORCES; ++f) {
            for (int k = 0; k < 3; ++k) {
                waves[half][LOAD][panel][f][k] = tangent->force[lane][panel][f][k];
            }
        }
        for (int node = 0; node < NAME_NODES; ++node) {
            const real *const a = m->waves[!half][RIGHT][panel][node];
            const real *const b = m->waves[!half][LEFT][panel][node + 2];
            const real *const da = waves[!half][RIGHT][panel][node];
            const real *const db = waves[!half][LEFT][panel][node + 2];
            real *const left = waves[half][LEFT][panel][node + 1];
            real *const right = waves[half][RIGHT][panel][node + 1];
            const int f = force_on[node];
            for (int k = 0; k <= degree; ++k) {
                p[k] = law->alpha[node] * da[k] + law->beta[node] * db[k] + slope->alpha[node] * a[k] +
                       slope->beta[node] * b[k];
            }
            p[degree + 1] = 0;
            for (int k = 0; f >= 0 && k < 3; ++k) {
                p[k] += tangent->force[lane][panel][f][k];
            }
            const real *sent = p;
            if (law->rate[node] > 0) {
                const real share_of_rate = slope->rate[node] / law->rate[node];
                const real *const back = m->waves[half][LEFT][panel][node + 1];
                for (int k = 0; k <= degree; ++k) {
                    const real load = f >= 0 && k < 3 ? m->force[panel][f][k] : (real)0;
                    const real pushed = law->alpha[node] * a[k] + law->beta[node] * b[k] + load;
                    p[k] += share_of_rate * (pushed - (back[k] + a[k]));
                }
                const int row = m->row[panel * NAME_NODES + node];
                (void)moved(m, row, degree, p, q, &tangent->velocity[lane][node]);
                sent = q;
            }
            for (int k = 0; k <= degree; ++k) {
                left[k] = sent[k] - da[k];
                right[k] = sent[k] - db[k];
            }
        }
    }
}

/* Of the largest value of an output, about what `missed`, as a velocity, makes of it, at worst. */
static real estimated(const model_of *m, const laws *law, real missed)
{
    real worst = 0;
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        real weight = 0;
        for (int k = 0; k < NAME_HEARD; ++k) {
            weight += heard_output[k] == output ? magnitude(law->gain[k]) : (real)0;
        }
        if (m->largest[output] > 0) {
            worst = larger(worst, weight * missed / m->largest[output]);
        }
    }
    return worst;
}

/* What begins a model. 0, or 1 for a bad number. */
static int begun(model_of *m, const name_parameters *parameters, laws *law)
{
    m->built = 0;
    m->estimate = not_a_number();
    if (!good(parameters)) {
        return 1;
    }
    laws_of(parameters, law);
    if (!laws_within_reach(law)) {
        return 1;
    }
    for (int event = 0; event < NAME_EVENTS; ++event) {
        m->change[event] = law->load[event_load[event]] * law->strength[event_strength[event]];
    }
    start_waves(m->waves, law, LEAST);
    start_sums(m->total, m->load, m->since);
    for (int node = 0; node < NAME_NODES; ++node) {
        m->velocity[0][node] = law->motion[node];
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        m->largest[output] = 0;
    }
    tabulate(m, law, LEAST);
    return 0;
}

/* How far a build has come. */
typedef struct {
    int window, degree, event;
    size_t place;
    real missed, size;
} progress;

/* The next window, at the lowest degree, raised by quarters, that misses no more than its share. */
static int next_window(model_of *m, const laws *law, progress *now)
{
    const int half = now->window % 2;
    now->event = press(m->change, m->load, m->since, m->force, now->window, now->event);
    for (;;) {
        real seen = now->size;
        const real leak = march(m, law, half, now->degree, &seen);
        if (leak <= share * seen) {
            now->missed += leak;
            now->size = seen;
            break;
        }
        if (now->degree == NAME_DEGREE) {
            return finite_number(leak) && finite_number(seen) ? 2 : 1;
        }
        const int higher = now->degree + now->degree / 4;
        const int next = higher < NAME_DEGREE ? higher : NAME_DEGREE;
        lengthen(m->waves, now->degree, next);
        tabulate(m, law, next);
        now->degree = next;
    }
    for (int node = 0; node < NAME_NODES; ++node) {
        m->velocity[0][node] = m->velocity[1][node];
    }
    m->degree[now->window] = now->degree;
    m->place[now->window] = now->place;
    return 0;
}

/* The outputs on a window that has been marched; then the next one is due. */
static void kept(model_of *m, const laws *law, progress *now)
{
    real *const all = m->series + now->place;
    clear(all, now->degree);
    listen(m, m->waves, law->gain, m->total, now->window % 2, now->degree, all);
    look(m, all, now->degree);
    now->place += (size_t)NAME_STRANDS * (size_t)(now->degree + 2);
    now->window += 1;
}

static int ended(model_of *m, const laws *law, const progress *now)
{
    const real missed = 4 * now->missed + unit * (real)(now->degree + NAME_WINDOWS) * now->size;
    m->estimate = estimated(m, law, missed);
    m->built = finite_number(now->size) && finite_number(m->estimate);
    return !m->built;
}

int name_build(name_model *model, const name_parameters *parameters)
{
    laws law;
    progress now = {0, LEAST, 0, 0, 0, 0};
    int status = begun(model, parameters, &law);
    while (status == 0 && now.window < NAME_WINDOWS) {
        status = next_window(model, &law, &now);
        if (status == 0) {
            kept(model, &law, &now);
        }
    }
    return status ? status : ended(model, &law, &now);
}

/* What begins the derivatives by a parameter. 0, or 1 where they are beyond all numbers. */
static int begun_lane(name_tangent *tangent, const laws *law, const laws *slope, int lane)
{
    if (!laws_within_reach(slope)) {
        return 1;
    }
    for (int event = 0; event < NAME_EVENTS; ++event) {
        const int own = LOAD_LANE >= 0 && lane == LOAD_LANE + event_load[event];
        tangent->change[lane][event] = law->load[event_load[event]] * slope->strength[event_strength[event]] +
                                       (own ? law->strength[event_strength[event]] : (real)0);
    }
    start_waves(tangent->waves[lane], slope, LEAST);
    start_sums(tangent->total[lane], tangent->load[lane], tangent->since[lane]);
    for (int node = 0; node < NAME_NODES; ++node) {
        tangent->velocity[lane][node] = slope->motion[node];
    }
    return 0;
}

int name_build_tangent(name_tangent *tangent, const name_parameters *parameters)
{
    model_of *const m = &tangent->value;
    laws law, slope;
    progress now = {0, LEAST, 0, 0, 0, 0};
    int status = begun(m, parameters, &law);
    for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
        slopes_of(parameters, lane, &slope);
        status = begun_lane(tangent, &law, &slope, lane);
    }
    while (status == 0 && now.window < NAME_WINDOWS) {
        const int before = now.degree;
        const int first = now.event;
        const int half = now.window % 2;
        status = next_window(m, &law, &now);
        for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
            real total[NAME_HEARD + 1];
            real *const all = tangent->series[lane] + now.place;
            slopes_of(parameters, lane, &slope);
            lengthen(tangent->waves[lane], before, now.degree);
            (void)press(tangent->change[lane], tangent->load[lane], tangent->since[lane], tangent->force[lane],
                        now.window, first);
            follow(tangent, &law, &slope, lane, half, now.degree);
            clear(all, now.degree);
            listen(m, tangent->waves[lane], law.gain, tangent->total[lane], half, now.degree, all);
            /* and where parameters change what outputs weigh, the waves themselves */
            int weighs = 0;
            for (int k = 0; k < NAME_HEARD; ++k) {
                total[k] = m->total[k];
                weighs |= magnitude(slope.gain[k]) > 0;
            }
            if (weighs) {
                listen(m, m->waves, slope.gain, total, half, now.degree, all);
            }
        }
        if (status == 0) {
            kept(m, &law, &now);
        }
    }
    return status ? status : ended(m, &law, &now);
}

name_real name_error_estimate(const name_model *model)
{
    return model->estimate;
}

static int inside(const model_of *m, real tau)
{
    return m->built && tau >= 0 && tau <= NAME_TAU_MAX;
}

static int section_at(real t)
{
    int section = 0;
    while (section + 1 < SECTIONS && t >= from[section + 1]) {
        ++section;
    }
    return section;
}

/* An output on a section of a window, t after the start of that. */
static real value(const model_of *m, int window, int section, int output, real t)
{
    const int at = section * NAME_OUTPUTS + output;
    const int degree = m->degree[window];
    real sum = 0;
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        const int s = strand_at[k];
        const real u = ((t - strand_start[s]) + strand_excess[s]) * strand_scale[s] - 1;
        sum += series_at(m->series + m->place[window] + (size_t)s * (size_t)(degree + 2), degree + 1, u);
    }
    return sum;
}

int name_model_eval(const name_model *model, name_real tau, name_real *out)
{
    if (!inside(model, tau)) {
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            out[output] = not_a_number();
        }
        return 1;
    }
    const int window = (int)tau;
    const real t = tau - (real)window;
    const int section = section_at(t);
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        out[output] = value(model, window, section, output, t);
    }
    return 0;
}

/* tau_k, both operations rounded. `one` is 1, which no compiler knows: so the product is rounded by itself, contracted
 * into the next operation or not. */
static real instant(real tau0, real dtau, real one, real k)
{
    const real step = k * dtau;
    return step * one + tau0;
}

/* The samples that are asked for, of a model's series or of its derivatives: `out` has `count` for each output. */
typedef struct {
    real tau0, dtau, one, per_tau;
    size_t count;
    real *out;
    const real *series;
} samples;

static const real offset[BLOCK] = {
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
};

/* A block of values of a series, added to what is there where `more`. */
static void block(const real *c, int degree, const real *u, int more, real *out)
{
    real next[BLOCK], after[BLOCK];
    const real highest = c[degree];
    UNROLLED
    for (int j = 0; j < BLOCK; ++j) {
        next[j] = highest;
        after[j] = 0;
    }
    for (int k = degree - 1; k > 0; --k) {
        const real add = c[k];
        UNROLLED
        for (int j = 0; j < BLOCK; ++j) {
            const real now = u[j] * (next[j] + next[j]) + (add - after[j]);
            after[j] = next[j];
            next[j] = now;
        }
    }
    const real mean = c[0];
    UNROLLED
    for (int j = 0; j < BLOCK; ++j) {
        const real sum = u[j] * next[j] + (mean - after[j]);
        out[j] = more ? out[j] + sum : sum;
    }
}

/* A block of an output at t after the start of a window. */
static void output_block(const model_of *m, const real *series, int window, int at, const real *t, real *out)
{
    const int degree = m->degree[window];
    real u[BLOCK];
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        const int s = strand_at[k];
        const real begin = strand_start[s], excess = strand_excess[s], scale = strand_scale[s];
        UNROLLED
        for (int j = 0; j < BLOCK; ++j) {
            u[j] = ((t[j] - begin) + excess) * scale - 1;
        }
        block(series + m->place[window] + (size_t)s * (size_t)(degree + 2), degree + 1, u, k > first_strand[at], out);
    }
    for (int j = 0; first_strand[at] == first_strand[at + 1] && j < BLOCK; ++j) {
        out[j] = 0;
    }
}

/* Samples k ... end - 1, all of them on one section of a window. Whole blocks are written: what is beyond the end is
 * written anew by the runs that follow. */
static void run(const model_of *m, int window, int section, const samples *s, size_t k, size_t end)
{
    const real begin = (real)window;
    real t[BLOCK], rest[BLOCK];
    for (; k < end; k += BLOCK) {
        const real first = (real)k, tau0 = s->tau0, dtau = s->dtau, one = s->one;
        UNROLLED
        for (int j = 0; j < BLOCK; ++j) {
            t[j] = instant(tau0, dtau, one, first + offset[j]) - begin;
        }
        const size_t left = s->count - k;
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            const int at = section * NAME_OUTPUTS + output;
            real *const row = s->out + (size_t)output * s->count + k;
            output_block(m, s->series, window, at, t, left < BLOCK ? rest : row);
            for (size_t j = 0; left < BLOCK && j < left; ++j) {
                row[j] = rest[j];
            }
        }
    }
}

static int on_section(const model_of *m, int window, int section, const samples *s, size_t k)
{
    const real tau = instant(s->tau0, s->dtau, s->one, (real)k);
    const real t = tau - (real)window;
    return inside(m, tau) && t >= from[section] && t < from[section + 1];
}

/* The first sample after k that is not where sample k is, or count. */
static size_t run_end(const model_of *m, int window, int section, const samples *s, size_t k)
{
    const real edge = (real)window + (s->dtau < 0 ? from[section] : from[section + 1]);
    const real reach = (edge - s->tau0) * s->per_tau; /* about where the run ends */
    size_t end = reach < (real)s->count ? (reach > (real)k ? (size_t)reach : k) + 1 : s->count;
    end = end > s->count ? s->count : end;
    while (end > k + 1 && !on_section(m, window, section, s, end - 1)) {
        --end;
    }
    while (end < s->count && on_section(m, window, section, s, end)) {
        ++end;
    }
    return end;
}

static int sampled(const model_of *m, const real *series, real tau0, real dtau, size_t count, real *out)
{
    const volatile real unity = 1;
    const samples s = {tau0, dtau, unity, dtau < 0 || dtau > 0 ? 1 / dtau : 0, count, out, series};
    int outside = 0;
    size_t k = 0;
    while (k < count) {
        const real tau = instant(tau0, dtau, s.one, (real)k);
        if (inside(m, tau)) {
            const int window = (int)tau;
            const int section = section_at(tau - (real)window);
            const size_t end = run_end(m, window, section, &s, k);
            run(m, window, section, &s, k, end);
            k = end;
        } else {
            for (size_t output = 0; output < NAME_OUTPUTS; ++output) {
                out[output * count + k] = not_a_number();
            }
            outside = 1;
            ++k;
        }
    }
    return outside;
}

int name_model_sample(const name_model *model, name_real tau0, name_real dtau, size_t count, name_real *out)
{
    return sampled(model, model->series, tau0, dtau, count, out);
}

int name_tangent_sample(
    const name_tangent *tangent, name_real tau0, name_real dtau, size_t count, name_real *out)
{
    const model_of *const m = &tangent->value;
    int outside = sampled(m, m->series, tau0, dtau, count, out);
    for (size_t lane = 0; lane < NAME_LANES; ++lane) {
        outside |= sampled(m, tangent->series[lane], tau0, dtau, count, out + (lane + 1) * NAME_OUTPUTS * count);
    }
    return outside;
}
