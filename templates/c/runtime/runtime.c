/* runtime.c: a march under parameters that come at run time, and its polynomials, one by one and in blocks.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#define NAME_MARCHED
#include "series.c"

/* Bytes of vectors of many sets. */
#define WIDE VECTOR

enum { LEFT = 0, RIGHT = 1, LOAD = 2, RATIO = 0, FIRST = 1, LAST = 2, SLACK = 0, LOSS = 1, LEAK = 2 };

typedef real wave_of[NAME_PANELS][NAME_NODES + 2][NAME_ROW];

/* How many numbers of a wave follow its series: zeros. */
enum { SPARE = NAME_ROW - NAME_DEGREE };

/* Which waves and bodies differ from what they were at first, LIT, and which differ from that as a parameter changes,
 * CHANGED, window by window, as march sends them: what numbers that cancel leave of outputs does not matter. */
enum { LIT = 1, CHANGED = 2 };

static int differs(real value, real slope)
{
    return (magnitude(value) > 0 ? LIT : 0) | (magnitude(slope) > 0 ? CHANGED : 0);
}

static int reached(const laws *law, const laws *slope, int lane, int output)
{
    const int wanted = lane == OF_VALUES ? LIT : CHANGED;
    int lit[2][3][NAME_PANELS][NAME_NODES + 2];
    int stirred[NAME_NODES];
    int turned[NAME_NODES]; /* whether a node answers otherwise */
    int pushed[NAME_FORCES + 1] = {0};
    int event = 0;
    for (int way = LEFT; way <= LOAD; ++way) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            for (int node = 0; node < NAME_NODES + 2; ++node) {
                lit[0][way][panel][node] = lit[1][way][panel][node] = 0;
            }
        }
    }
    for (int node = 0; node < NAME_NODES; ++node) {
        const real alpha = magnitude(law->alpha[node]), beta = magnitude(law->beta[node]);
        const int beside = alpha > 0 ? node : node + 1;
        stirred[node] = 0;
        if (alpha > 0 && beta > 0) {
            stirred[node] |= differs(law->rod[node] - law->rod[node + 1], slope->rod[node] - slope->rod[node + 1]);
        }
        if (is_body[node]) {
            stirred[node] |= differs(law->motion[node] - law->rod[beside], slope->motion[node] - slope->rod[beside]);
        }
        turned[node] = magnitude(slope->alpha[node]) > 0 || magnitude(slope->beta[node]) > 0 ||
                       magnitude(slope->rate[node]) > 0;
    }
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        const int half = window % 2;
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            for (; event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel; ++event) {
                const real load = law->load[event_load[event]], strength = law->strength[event_strength[event]];
                const int own = LOAD_LANE >= 0 && lane == LOAD_LANE + event_load[event];
                pushed[event_force[event]] |=
                    differs(load, load * slope->strength[event_strength[event]]) | differs(0, own ? strength : (real)0);
            }
            for (int f = 0; f < NAME_FORCES; ++f) {
                lit[half][LOAD][panel][f] = pushed[f];
            }
            for (int node = 0; node < NAME_NODES; ++node) {
                const int a = lit[!half][RIGHT][panel][node], b = lit[!half][LEFT][panel][node + 2];
                const real alpha = law->alpha[node], beta = law->beta[node];
                const int from_left = magnitude(alpha) > 0 ? a : 0, from_right = magnitude(beta) > 0 ? b : 0;
                stirred[node] |= (force_on[node] >= 0 ? pushed[force_on[node]] : 0) |
                                 (is_body[node] ? from_left | from_right : 0);
                const int more = turned[node] && ((stirred[node] | a | b) & LIT) ? CHANGED : 0;
                stirred[node] |= is_body[node] ? more : 0;
                lit[half][LEFT][panel][node + 1] =
                    stirred[node] | more | from_right | (magnitude(alpha - 1) > 0 ? a : 0);
                lit[half][RIGHT][panel][node + 1] =
                    stirred[node] | more | from_left | (magnitude(beta - 1) > 0 ? b : 0);
            }
        }
        for (int section = 0; section < SECTIONS && (real)window + from[section] <= NAME_TAU_MAX; ++section) {
            const int at = section * NAME_OUTPUTS + output;
            for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
                for (int t = first_term[strand_at[k]]; t < first_term[strand_at[k] + 1]; ++t) {
                    const int then = term_back[t] ? !half : half;
                    const int wave = lit[then][term_way[t]][term_panel[t]][term_sender[t]];
                    const int weighs = differs(law->gain[term_heard[t]], slope->gain[term_heard[t]]);
                    const int heard = (weighs & LIT ? wave : 0) | (wave & LIT ? weighs & CHANGED : 0);
                    if (heard & wanted) {
                        return 1;
                    }
                }
            }
        }
    }
    return 0;
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

/* 0, or 1 for a bad number, or where a body has become so heavy that it is none. */
static int refused(const laws *law)
{
    int within = laws_within_reach(law);
    for (int node = 0; node < NAME_NODES; ++node) {
        within &= !is_body[node] || law->rate[node] > 0;
    }
    return !within;
}

/* The tables of bodies for polynomials of a degree: the elimination of q_k + x_k (q_(k-1) - q_(k+1)) = x_k (p_(k-1) -
 * p_(k+1)) from the highest k down. Bodies of equal rate on panels of equal length share them. */
static void tabulate(work_of *m, const laws *law, int degree)
{
    tell_inverses(m->inverse, degree + SPARE);
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
                    for (int k = 0; k < degree + SPARE; ++k) {
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

/* Series of higher degree: what they had not is 0. */
static void lengthen(wave_of (*waves)[3], int degree, int higher)
{
    for (int half = 0; half < 2; ++half) {
        for (int way = LEFT; way <= LOAD; ++way) {
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                for (int node = 0; node < NAME_NODES + 2; ++node) {
                    for (int k = degree + 1; k < higher + SPARE; ++k) {
                        waves[half][way][panel][node][k] = 0;
                    }
                }
            }
        }
    }
}

/* What is sent by a node on a panel; `size` grows to the largest mean of a wave. */
static void send(wave_of (*waves)[3], int half, int panel, int node, int degree, const real *sent, real *size)
{
    const real *const a = waves[!half][RIGHT][panel][node];
    const real *const b = waves[!half][LEFT][panel][node + 2];
    real *const left = waves[half][LEFT][panel][node + 1];
    real *const right = waves[half][RIGHT][panel][node + 1];
    for (int k = 0; k <= degree; ++k) {
        left[k] = sent[k] - a[k];
        right[k] = sent[k] - b[k];
    }
    *size = larger(larger(*size, left[0]), right[0]);
}

/* Bodies are moved in pairs: each step of a recurrence waits for the one before, so that two take as long as one. */
enum { PAIR = 2 };

/* Up to a pair of bodies on a panel: what arrives at each, and its velocity. */
typedef struct {
    int count;
    int node[PAIR];
    real p[PAIR][NAME_DEGREE + 2];
    real q[PAIR][NAME_DEGREE + 1];
} moving;

/* The velocities of bodies on a panel, and what they send; one alone is moved twice. `velocity` goes from its start to
 * its end. What the polynomials miss. */
static real moved(const work_of *m, wave_of (*waves)[3], int half, int panel, int degree, moving *bodies, real *velocity,
                  real *size)
{
    const int second = bodies->count - 1;
    const int row = m->row[panel * NAME_NODES + bodies->node[0]];
    const int other = m->row[panel * NAME_NODES + bodies->node[second]];
    const real *const ratio[PAIR] = {m->table[row][RATIO], m->table[other][RATIO]};
    const real *const first[PAIR] = {m->table[row][FIRST], m->table[other][FIRST]};
    const real *const last[PAIR] = {m->table[row][LAST], m->table[other][LAST]};
    const real *const p[PAIR] = {bodies->p[0], bodies->p[second]};
    real *const q[PAIR] = {bodies->q[0], bodies->q[second]};
    real y[PAIR] = {0, 0}, begun[PAIR] = {0, 0}, ended[PAIR] = {0, 0};
    real missed = 0;
    for (int k = degree; k > 0; --k) {
        UNROLLED
        for (int j = 0; j < PAIR; ++j) {
            const real change = (k == 1 ? 2 * p[j][0] : p[j][k - 1]) - p[j][k + 1];
            y[j] = ratio[j][k] * change + ratio[j][k] * y[j];
            q[j][k] = y[j];
            begun[j] += first[j][k] * y[j];
            ended[j] += last[j][k] * y[j];
        }
    }
    for (int j = 0; j < bodies->count; ++j) {
        const int node = bodies->node[j];
        const real *const edge = m->edge[m->row[panel * NAME_NODES + node]];
        const real rest = velocity[node] - begun[j];
        q[j][0] = rest - edge[SLACK] * rest;
        velocity[node] = q[j][0] + (ended[j] - edge[LOSS] * q[j][0]);
    }
    for (int j = 0; j < PAIR; ++j) {
        y[j] = 2 * q[j][0];
    }
    for (int k = 1; k <= degree; ++k) {
        UNROLLED
        for (int j = 0; j < PAIR; ++j) {
            y[j] = q[j][k] - ratio[j][k] * y[j];
        }
        UNROLLED
        for (int j = 0; j < PAIR; ++j) {
            q[j][k] = y[j];
        }
    }
    for (int j = 0; j < bodies->count; ++j) {
        const int node = bodies->node[j];
        missed += m->edge[m->row[panel * NAME_NODES + node]][LEAK] * magnitude(q[j][degree] - p[j][degree]);
        *size = larger(*size, velocity[node]);
        send(waves, half, panel, node, degree, q[j], size);
    }
    bodies->count = 0;
    return missed;
}

/* One window at a degree, from the waves of the window before in the other half. What its polynomials miss; `size`
 * grows to the largest velocity or mean of a wave. */
static real march(work_of *m, const laws *law, int half, int degree, real *size)
{
    moving bodies;
    real missed = 0;
    bodies.count = 0;
    bodies.node[0] = 0;
    bodies.node[1] = 0;
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
            real *const p = bodies.p[bodies.count];
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
            if (law->rate[node] > 0) {
                bodies.node[bodies.count] = node;
                bodies.count += 1;
            } else {
                send(m->waves, half, panel, node, degree, p, size);
            }
            if (bodies.count == PAIR || (bodies.count > 0 && node == NAME_NODES - 1)) {
                missed += moved(m, m->waves, half, panel, degree, &bodies, m->velocity[1], size);
            }
        }
    }
    return missed;
}

/* Add to all strands of a window what is heard of waves: each times its gain, or their integrals from tau = 0 on, of
 * which `total` is what windows before have brought. */
static void listen(const work_of *m, wave_of (*waves)[3], const real *gains, real *total, int window, int degree,
                   real *all)
{
    const int half = window % 2;
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

/* What begins a march. */
static void started(work_of *m, const laws *law)
{
    start_waves(m->waves, law, LEAST);
    for (int node = 0; node < NAME_NODES; ++node) {
        m->velocity[0][node] = law->motion[node];
    }
    tabulate(m, law, LEAST);
}

/* The next window begins as this one ends. */
static void settle(work_of *m)
{
    for (int node = 0; node < NAME_NODES; ++node) {
        m->velocity[0][node] = m->velocity[1][node];
    }
}

/* The window of now at the degree of now. */
static void march_window(work_of *m, const laws *law, progress *now)
{
    now->seen = now->size;
    now->leak = march(m, law, now->window % 2, now->degree, &now->seen);
}

/* The same at a higher degree. */
static void heighten(work_of *m, const laws *law, progress *now)
{
    const int higher = higher_than(now->degree);
    lengthen(m->waves, now->degree, higher);
    tabulate(m, law, higher);
    now->degree = higher;
    march_window(m, law, now);
}
