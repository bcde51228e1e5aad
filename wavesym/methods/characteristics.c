/* The method of characteristics on a grid, with exponential integration at the points.
 *
 * Time is cut into windows, of which every delay is a whole number. What arrives at an end of a bar in a window was sent
 * by its other end in a window before. The velocity q of a point is that of   mass q' + gamma q = r,   where r is the sum
 * of weight * what arrives over its ends, and its loads; with r the polynomial through POINTS neighbouring samples: order
 * 2 with 2 of them, 4 with 4. Windows are cut into panels where loads may jump; no polynomial reaches over a cut.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

enum { BEFORE = POINTS / 2 - 1 };   /* samples of an inner stencil before the step itself */
enum { STENCILS = 1 + 3 * POINTS }; /* decay over a step; gains at the first, an inner and the last step of a panel */

/* Waves are numbered by the ends that send them, left and right ones by turns; then come the velocities of points. */
struct grid {
    size_t points, ends, panels, samples, events, terms, outputs, windows, depth; /* depth: windows that are kept */
    double window;                       /* how long it is */
    const size_t *massless;              /* of points; the weights and loads of those without mass are over gamma */
    const double *stencils;              /* [panel][point + 1][STENCILS]; the last point's are for plain integrals */
    const double *velocity, *before;     /* of points at tau = 0; of the waves before it */
    const double *start, *step;          /* of panels */
    const size_t *steps, *first;         /* a panel's samples are first ... first + steps */
    const size_t *first_end, *end_of;    /* the ends at a point are end_of[first_end[point]] ... */
    const size_t *lag;                   /* of ends, in windows */
    const double *ratio, *weight;        /* of ends */
    const size_t *event_window, *event_panel, *event_point;
    const double *event_load;            /* [event][3] */
    /* an output is a sum of waves, or of their integrals; the one with the largest lag comes first in every window */
    const size_t *term_output, *term_wave, *term_integral, *term_first;
    const double *term_sign, *term_lag, *term_base;
};

static size_t window_size(const struct grid *g)
{
    return (g->ends + g->points) * g->samples;
}

/* What arrived at an end in window n, as its other end sent it; `kept` are the last windows. */
static const double *arriving(const struct grid *g, const double *kept, size_t n, size_t end)
{
    return kept + (n + g->depth - g->lag[end]) % g->depth * window_size(g) + (end ^ 1) * g->samples;
}

/* q at the samples of a panel; r and q may not overlap. */
static void integrate(const double *stencil, size_t steps, const double *restrict r, double *restrict q)
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
static size_t first_from(const double *tau, size_t k, size_t count, double limit)
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
        const double *field = (g->term_integral[term] ? integrals : waves) + g->term_wave[term] * g->samples;
        const double origin = n * g->window + g->term_lag[term];
        size_t k = first_from(tau, 0, count, origin);
        for (size_t p = 0; p < g->panels && k < count; ++p) {
            const double until = p + 1 < g->panels ? g->start[p + 1] : g->window;
            const size_t end = first_from(tau, k, count, origin + until);
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
            double *to = integrals + wave * g->samples + g->first[p];
            to[0] = p ? to[-1] : total[term];
            integrate(g->stencils + (p * (g->points + 1) + g->points) * STENCILS, g->steps[p],
                      waves + wave * g->samples + g->first[p], to);
        }
        total[term] = integrals[wave * g->samples + g->samples - 1];
    }
}

/* How far apart ascending tau are, 0 where not evenly. */
static double spacing_of(const double *tau, size_t count)
{
    const double dtau = count > 1 ? (tau[count - 1] - tau[0]) / (double)(count - 1) : 0;
    double worst = 0;
    for (size_t k = 0; k < count; ++k) {
        const double off = fabs(tau[0] + dtau * (double)(int)k - tau[k]);
        worst = off > worst ? off : worst;
    }
    return worst < 1e-12 * (1 + tau[count - 1]) ? dtau : 0;
}

/* The waves that leave a point's ends in a panel, and its velocity q; `load` is moved on to the end of the panel. Ends are
 * taken two at a time, as most points have two: the second of an odd one is the first again, without weight. */
static void pass_point(const struct grid *g, size_t point, size_t panel, double *kept, size_t n, double *load,
                       double *velocity, double *work)
{
    const size_t samples = g->steps[panel] + 1, at = g->first[panel];
    const double step = g->step[panel], length = step * (double)g->steps[panel];
    const size_t *const from = g->end_of + g->first_end[point], *const to = g->end_of + g->first_end[point + 1];
    double *now = kept + n % g->depth * window_size(g);
    double *q = now + (g->ends + point) * g->samples + at, *r = g->massless[point] ? q : work;
    const double f0 = load[0], f1 = load[1], f2 = load[2];
    for (const size_t *end = from; end < to; end += 2) {
        const size_t other = end + 1 < to ? end[1] : *end;
        const double *restrict a = arriving(g, kept, n, *end) + at, *restrict b = arriving(g, kept, n, other) + at;
        const double alpha = g->weight[*end], beta = other != *end ? g->weight[other] : 0;
        if (end == from) {
            for (size_t k = 0; k < samples; ++k) {
                r[k] = alpha * a[k] + beta * b[k];
            }
        } else {
            for (size_t k = 0; k < samples; ++k) {
                r[k] += alpha * a[k] + beta * b[k];
            }
        }
    }
    if (f0 != 0 || f1 != 0 || f2 != 0) {
        for (size_t k = 0; k < samples; ++k) {
            const double t = step * (double)(int)k;
            r[k] += f0 + t * (f1 + t * f2);
        }
        load[0] += length * (f1 + length * f2);
        load[1] += 2 * length * f2;
    }
    if (!g->massless[point]) {
        q[0] = *velocity;
        integrate(g->stencils + (panel * (g->points + 1) + point) * STENCILS, g->steps[panel], r, q);
        *velocity = q[samples - 1];
    }
    for (const size_t *end = from; end < to; end += 2) {
        const size_t other = end + 1 < to ? end[1] : *end;
        const double *restrict a = arriving(g, kept, n, *end) + at, *restrict b = arriving(g, kept, n, other) + at;
        double *left = now + *end * g->samples + at, *right = now + other * g->samples + at;
        const double one = g->ratio[*end], two = g->ratio[other];
        for (size_t k = 0; k < samples; ++k) {
            left[k] = one * q[k] - a[k];
            right[k] = two * q[k] - b[k];
        }
    }
}

/* out[output*count + k] at ascending tau[k]; count is at least 1.
 * work: samples*((ends + points)*(depth + 1) + 1) + 4*points + terms doubles. */
void sample(const struct grid *g, const double *tau, size_t count, double *out, double *work)
{
    const double dtau = spacing_of(tau, count);
    const size_t size = window_size(g);
    double *integrals = work + g->depth * size, *r = integrals + size;
    double *velocity = r + g->samples, *load = velocity + g->points, *total = load + 3 * g->points;
    size_t event = 0;
    memset(load, 0, 3 * g->points * sizeof *load);
    memset(integrals, 0, size * sizeof *integrals);
    memset(total, 0, g->terms * sizeof *total);
    memcpy(velocity, g->velocity, g->points * sizeof *velocity);
    for (size_t wave = 0; wave < g->ends + g->points; ++wave) {
        for (size_t d = 0; d < g->depth; ++d) {
            for (size_t k = 0; k < g->samples; ++k) {
                work[d * size + wave * g->samples + k] = g->before[wave];
            }
        }
    }
    for (size_t d = g->depth; d > 0; --d) {
        add_up(g, work, integrals, total);
        read_off(g, -(double)(int)d, work, integrals, tau, count, dtau, out);
    }
    for (size_t n = 0; n < g->windows; ++n) {
        for (size_t p = 0; p < g->panels; ++p) {
            for (; event < g->events && g->event_window[event] == n && g->event_panel[event] == p; ++event) {
                for (size_t j = 0; j < 3; ++j) {
                    load[3 * g->event_point[event] + j] += g->event_load[3 * event + j];
                }
            }
            for (size_t point = 0; point < g->points; ++point) {
                pass_point(g, point, p, work, n, load + 3 * point, velocity + point, r);
            }
        }
        add_up(g, work + n % g->depth * size, integrals, total);
        read_off(g, (double)(int)n, work + n % g->depth * size, integrals, tau, count, dtau, out);
    }
    for (size_t term = 0; term < g->terms; ++term) {
        if (g->term_integral[term]) {
            for (size_t k = 0; k < count; ++k) {
                out[g->term_output[term] * count + k] -= g->term_base[term];
            }
        }
    }
}
