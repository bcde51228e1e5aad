/* The method of characteristics on a grid, with exponential integration at the bodies.
 *
 * On every window [n, n + 1) of tau what arrives at a node was sent in the window before. There the node's velocity q is
 * that of   q' + rate q = r,   r = alpha a + beta b + loads,   with r the polynomial through POINTS neighbouring points:
 * order 2 with 2 of them, 4 with 4. Windows are cut into panels where loads may jump; no polynomial reaches over a cut.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

enum { BEFORE = POINTS / 2 - 1 };   /* points of an inner stencil before the step itself */
enum { STENCILS = 1 + 3 * POINTS }; /* decay over a step; gains at the first, an inner and the last step of a panel */

struct grid {
    size_t nodes, panels, points, events, terms, outputs, windows;
    const double *alpha, *beta, *instant; /* instant: 1/gamma of a node without mass, 0 at a body */
    const double *stencils;               /* [panel][node + 1][STENCILS]; the last node's are for plain integrals */
    const double *velocity, *before;      /* of bodies at tau = 0; of the waves [2][nodes] before it */
    const double *start, *step;           /* of panels */
    const size_t *steps, *first;          /* a panel's points are first ... first + steps */
    const size_t *event_window, *event_panel, *event_node;
    const double *event_load;             /* [event][3] */
    /* an output is a sum of waves, or of their integrals; that with the largest lag comes first in every window */
    const size_t *term_output, *term_wave, *term_integral, *term_first;
    const double *term_sign, *term_lag, *term_base;
};

/* q at the points of a panel; r and q may not overlap. */
static void carried(const double *stencil, size_t steps, const double *restrict r, double *restrict q)
{
    const double e1 = stencil[0], e2 = e1 * e1, e3 = e2 * e1, e4 = e2 * e2;
    const double *first = stencil + 1, *inner = first + POINTS, *last = inner + POINTS;
    double w[POINTS];
    size_t k;
    memcpy(w, inner, sizeof w);
    for (k = 1; k + 1 < steps; ++k) {
        double gain = 0;
        for (size_t j = 0; j < POINTS; ++j) {
            gain += w[j] * r[k + j - BEFORE];
        }
        q[k + 1] = gain;
    }
    q[1] = q[steps] = 0;
    for (size_t j = 0; j < POINTS; ++j) {
        q[1] += first[j] * r[j];
        q[steps] += last[j] * r[steps + 1 - POINTS + j];
    }
    /* four steps at once: what the gains add does not wait for q */
    for (k = 0; k + 4 <= steps; k += 4) {
        const double p1 = q[k + 1], p2 = e1 * p1 + q[k + 2], p3 = e1 * p2 + q[k + 3], p4 = e1 * p3 + q[k + 4];
        const double now = q[k];
        q[k + 1] = e1 * now + p1;
        q[k + 2] = e2 * now + p2;
        q[k + 3] = e3 * now + p3;
        q[k + 4] = e4 * now + p4;
    }
    for (; k < steps; ++k) {
        q[k + 1] += e1 * q[k];
    }
}

/* The first of tau[k] ... tau[count - 1] that is not below the limit, as far as rounding lets one tell. */
static size_t reached(const double *tau, size_t k, size_t count, double limit)
{
    while (k < count) {
        const size_t middle = k + (count - k) / 2;
        if (tau[middle] + 1e-12 < limit) {
            k = middle + 1;
        } else {
            count = middle;
        }
    }
    return k;
}

/* How samples lie on the grid of a panel: `stride` steps apart, or `split` of them to a step; else both are 0. */
struct spacing {
    size_t stride, split;
};

static struct spacing spacing(double dtau, double step)
{
    const double apart = dtau / step, within = dtau > 0 ? step / dtau : 0;
    struct spacing found = {(size_t)(apart + 0.5), (size_t)(within + 0.5)};
    if (fabs(apart - (double)found.stride) > 1e-10) {
        found.stride = 0;
    }
    /* with many samples to a step, going from step to step is as fast */
    if (found.split > 16 || fabs(within - (double)found.split) > 1e-10 * within) {
        found.split = 0;
    }
    return found;
}

/* out = sign * f if `first`, else out += sign * f, at tau[0] ... tau[count - 1], all in one panel from `origin` on. */
static void add(const double *f, size_t steps, double origin, double step, double sign, const double *tau, size_t count,
                struct spacing lie, size_t first, double *restrict out)
{
    const double scale = 1 / step;
    const double position = (tau[0] - origin) * scale;
    const double nearest = floor(position + 0.5);
    if (lie.stride && fabs(position - nearest) < 1e-8 && (size_t)nearest + (count - 1) * lie.stride <= steps) {
        const double *restrict from = f + (size_t)nearest;
        if (first) {
            for (size_t j = 0; j < count; ++j) {
                out[j] = sign * from[j * lie.stride];
            }
        } else if (lie.stride == 1) {
            for (size_t j = 0; j < count; ++j) {
                out[j] += sign * from[j];
            }
        } else {
            for (size_t j = 0; j < count; ++j) {
                out[j] += sign * from[j * lie.stride];
            }
        }
        return;
    }
    if (first) {
        memset(out, 0, count * sizeof *out);
    }
    const double part = position * (double)lie.split, whole = floor(part + 0.5);
    if (lie.split && fabs(part - whole) < 1e-8 && steps >= POINTS) {
        /* the same weights for every split-th sample; at the ends of the panel each sample for itself, below */
        const size_t at = (size_t)whole, inner = BEFORE * lie.split, beyond = (steps - BEFORE) * lie.split;
        const size_t low = at < inner ? inner - at : 0, high = beyond > at ? beyond - at : 0;
        const size_t from = low < count ? low : count, to = high < count ? high : count;
        if (from < to) {
            const struct spacing none = {0, 0};
            for (size_t phase = 0; phase < lie.split && from + phase < to; ++phase) {
                const size_t place = at + from + phase, i = place / lie.split;
                const double u = (double)(place % lie.split) / (double)lie.split + BEFORE;
                const size_t times = (to - from - phase + lie.split - 1) / lie.split;
                const double *restrict y = f + i - BEFORE;
                double *restrict target = out + from + phase;
                double w[POINTS];
                for (int j = 0; j < POINTS; ++j) {
                    w[j] = sign;
                    for (int other = 0; other < POINTS; ++other) {
                        w[j] *= other == j ? 1 : (u - other) / (j - other);
                    }
                }
                for (size_t n = 0; n < times; ++n) {
                    double value = 0;
                    for (size_t j = 0; j < POINTS; ++j) {
                        value += w[j] * y[n + j];
                    }
                    target[n * lie.split] += value;
                }
            }
            if (from > 0) {
                add(f, steps, origin, step, sign, tau, from, none, 0, out);
            }
            if (to < count) {
                add(f, steps, origin, step, sign, tau + to, count - to, none, 0, out + to);
            }
            return;
        }
    }
    const long most = (long)steps;
    for (size_t k = 0; k < count;) {
        const double here = (tau[k] - origin) * scale;
        long i = (long)here, base; /* signed: conversions to and from double are cheap */
        i = i < most ? i : most - 1;
        base = i > BEFORE ? i - BEFORE : 0;
        base = base < most + 1 - POINTS ? base : most + 1 - POINTS;
        const double *y = f + base;
        size_t next = k + 1;
        while (next < count && (i + 1 == most || (tau[next] - origin) * scale < (double)(i + 1))) {
            ++next;
        }
#if POINTS == 2
        const double c0 = sign * y[0], c1 = sign * (y[1] - y[0]);
        for (; k < next; ++k) {
            const double u = (tau[k] - origin) * scale - (double)base;
            out[k] += c0 + u * c1;
        }
#else
        /* Newton's form on the points 0, 1, 2, 3 */
        const double d1 = y[1] - y[0], d2 = (y[2] - 2 * y[1] + y[0]) / 2, d3 = (y[3] - 3 * (y[2] - y[1]) - y[0]) / 6;
        const double c0 = sign * y[0], c1 = sign * (d1 - d2 + 2 * d3), c2 = sign * (d2 - 3 * d3), c3 = sign * d3;
        for (; k < next; ++k) {
            const double u = (tau[k] - origin) * scale - (double)base;
            out[k] += c0 + u * (c1 + u * (c2 + u * c3));
        }
#endif
    }
}

/* What the waves of window n give to the outputs. */
static void read_off(const struct grid *g, double n, const double *waves, const double *integrals, const double *tau,
                     size_t count, double dtau, double *out)
{
    for (size_t term = 0; term < g->terms; ++term) {
        const double *field = (g->term_integral[term] ? integrals : waves) + g->term_wave[term] * g->points;
        const double origin = n + g->term_lag[term];
        size_t k = reached(tau, 0, count, origin);
        for (size_t p = 0; p < g->panels && k < count; ++p) {
            const double till = p + 1 < g->panels ? g->start[p + 1] : 1.0;
            const size_t end = reached(tau, k, count, origin + till);
            if (end > k) {
                add(field + g->first[p], g->steps[p], origin + g->start[p], g->step[p], g->term_sign[term], tau + k,
                    end - k, spacing(dtau, g->step[p]), g->term_first[term], out + g->term_output[term] * count + k);
            }
            k = end;
        }
    }
}

/* The integrals of the waves that displacements need; totals go on from window to window. */
static void add_up(const struct grid *g, const double *waves, double *integrals, double *total)
{
    for (size_t term = 0; term < g->terms; ++term) {
        const size_t wave = g->term_wave[term];
        for (size_t p = 0; g->term_integral[term] && p < g->panels; ++p) {
            double *to = integrals + wave * g->points + g->first[p];
            to[0] = p ? to[-1] : total[term];
            carried(g->stencils + (p * (g->nodes + 1) + g->nodes) * STENCILS, g->steps[p],
                    waves + wave * g->points + g->first[p], to);
        }
        total[term] = integrals[wave * g->points + g->points - 1];
    }
}

/* How far apart ascending tau are, 0 where not evenly. */
static double even(const double *tau, size_t count)
{
    const double dtau = count > 1 ? (tau[count - 1] - tau[0]) / (double)(count - 1) : 0;
    double worst = 0;
    for (size_t k = 0; k < count; ++k) {
        const double off = fabs(tau[0] + dtau * (double)(int)k - tau[k]);
        worst = off > worst ? off : worst;
    }
    return worst < 1e-12 * (1 + tau[count - 1]) ? dtau : 0;
}

/* out[output*count + k] at ascending tau[k]; count is at least 1.
 * work: points + nodes*(4*points + 2*points + 4) + terms doubles. */
void sample(const struct grid *g, const double *tau, size_t count, double *out, double *work)
{
    const double dtau = even(tau, count);
    const size_t size = 2 * g->nodes * g->points;
    double *waves[2] = {work, work + size};
    double *integrals = work + 2 * size, *r = integrals + size;
    double *velocity = r + g->points, *load = velocity + g->nodes, *total = load + 3 * g->nodes;
    size_t event = 0;
    memset(load, 0, 3 * g->nodes * sizeof *load);
    memset(integrals, 0, size * sizeof *integrals);
    memset(total, 0, g->terms * sizeof *total);
    memcpy(velocity, g->velocity, g->nodes * sizeof *velocity);
    for (size_t wave = 0; wave < 2 * g->nodes; ++wave) {
        for (size_t k = 0; k < g->points; ++k) {
            waves[0][wave * g->points + k] = g->before[wave];
        }
    }
    add_up(g, waves[0], integrals, total);
    read_off(g, -1.0, waves[0], integrals, tau, count, dtau, out);
    for (size_t n = 0; n < g->windows; ++n) {
        const double *old = waves[n % 2];
        double *new = waves[(n + 1) % 2];
        for (size_t p = 0; p < g->panels; ++p) {
            const size_t points = g->steps[p] + 1, at = g->first[p];
            const double length = g->step[p] * (double)g->steps[p];
            for (; event < g->events && g->event_window[event] == n && g->event_panel[event] == p; ++event) {
                for (size_t j = 0; j < 3; ++j) {
                    load[3 * g->event_node[event] + j] += g->event_load[3 * event + j];
                }
            }
            for (size_t x = 0; x < g->nodes; ++x) {
                /* beyond the ends there is nothing: alpha, beta are 0 there, and any wave will do */
                const double *restrict a = old + (g->nodes + (x > 0 ? x - 1 : 0)) * g->points + at;
                const double *restrict b = old + (x + 1 < g->nodes ? x + 1 : x) * g->points + at;
                double *restrict left = new + x * g->points + at;
                double *restrict right = new + (g->nodes + x) * g->points + at;
                const double alpha = g->alpha[x], beta = g->beta[x], instant = g->instant[x];
                double *force = load + 3 * x;
                for (size_t k = 0; k < points; ++k) {
                    r[k] = alpha * a[k] + beta * b[k];
                }
                if (force[0] != 0 || force[1] != 0 || force[2] != 0) {
                    const double f0 = force[0], f1 = force[1], f2 = force[2], step = g->step[p];
                    for (size_t k = 0; k < points; ++k) {
                        const double t = step * (double)(int)k;
                        r[k] += f0 + t * (f1 + t * f2);
                    }
                    force[0] += length * (f1 + length * f2);
                    force[1] += 2 * length * f2;
                }
                if (instant != 0) {
                    for (size_t k = 0; k < points; ++k) {
                        const double q = instant * r[k];
                        left[k] = q - a[k];
                        right[k] = q - b[k];
                    }
                } else {
                    left[0] = velocity[x];
                    carried(g->stencils + (p * (g->nodes + 1) + x) * STENCILS, g->steps[p], r, left);
                    velocity[x] = left[points - 1];
                    for (size_t k = 0; k < points; ++k) {
                        const double q = left[k];
                        left[k] = q - a[k];
                        right[k] = q - b[k];
                    }
                }
            }
        }
        add_up(g, new, integrals, total);
        read_off(g, (double)(int)n, new, integrals, tau, count, dtau, out);
    }
    for (size_t term = 0; term < g->terms; ++term) {
        if (g->term_integral[term]) {
            for (size_t k = 0; k < count; ++k) {
                out[g->term_output[term] * count + k] -= g->term_base[term];
            }
        }
    }
}
