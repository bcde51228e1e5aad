/* series.c: what marches under parameters that come at run time share: series, loads, the size of outputs.
 * Plain C of a program of a scene called `name`; it stands below the first empty line in NAME.c, above the march. */
#include "tables.h"

/* So many samples are a block. */
enum { BLOCK = 16 };

static const slice nothing = {0};
#if VECTOR
#define AT(x, lane) ((x)[lane])
#define MAGNITUDE(x) ((slice)((choice)(x) & ~(choice)(-nothing)))
#define LARGER(x, y) ((slice)((((x) > (y)) & (choice)(x)) | (~((x) > (y)) & (choice)(y))))
#else
#define AT(x, lane) (x)
#define MAGNITUDE(x) magnitude(x)
#define LARGER(x, y) ((x) > (y) ? (x) : (y))
#endif

static real magnitude(real x)
{
    return x < 0 ? -x : x;
}

static const slice *slice_at(const real *x, size_t k)
{
    return (const slice *)(x + k);
}

static real total_of(const slice *x)
{
    slice sum = *x;
    for (int half = LANES / 2; half > 0; half /= 2) {
        for (int lane = 0; lane < half; ++lane) {
            AT(sum, lane) += AT(sum, lane + half);
        }
    }
    return AT(sum, 0);
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

/* 1 / (2 k), up to some k */
static void tell_inverses(real *inverse, int last)
{
    for (int k = 1; k <= last; ++k) {
        inverse[k] = 1 / (real)(2 * k);
    }
}

/* The antiderivative of a series, times 1 / half the length of the panel: all c_k but the first, which is 0. */
static void integrate(const work_of *m, const real *w, int degree, real *c)
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

static real larger(real one, real other)
{
    return magnitude(other) > one ? magnitude(other) : one;
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

/* The loads on the panels of a window, as series, after their changes there, the first of which is `event`. The first
 * one of the next window. */
static int press(const real *change, real (*load)[3], int (*since)[2], real (*force)[NAME_FORCES + 1][3], int window,
                 int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        while (event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel) {
            const int f = event_force[event];
            real *const c = load[f];
            const real gone =
                (real)(window - since[f][0]) * window_length + since_panel[panel * NAME_PANELS + since[f][1]];
            c[0] += gone * (c[1] + gone * c[2]);
            c[1] += 2 * gone * c[2];
            for (int k = 0; k < 3 && event_power[event] >= 3; ++k) {
                c[k] = 0; /* what acts is told anew */
            }
            c[event_power[event] % 3] += change[event];
            since[f][0] = window;
            since[f][1] = panel;
            ++event;
        }
        const real half = half_length[panel];
        for (int f = 0; f < NAME_FORCES; ++f) {
            const real *const c = load[f];
            const real gone =
                (real)(window - since[f][0]) * window_length + since_panel[panel * NAME_PANELS + since[f][1]];
            const real middle = gone + half;
            force[panel][f][0] = (c[0] + middle * c[1]) + (middle * middle + half * half / 2) * c[2];
            force[panel][f][1] = half * (c[1] + 2 * middle * c[2]);
            force[panel][f][2] = half * half / 2 * c[2];
        }
    }
    return event;
}

static void clear(real *all, int degree)
{
    for (size_t k = 0; k < (size_t)NAME_STRANDS * (size_t)(degree + 2); ++k) {
        all[k] = 0;
    }
}

/* When the cycle of a window begins: after CYCLE windows, which are `span` long, tau is a whole number again. */
static real cycle_begin(int window)
{
    return (real)(window / CYCLE) * span;
}

/* Where a section of a window is among those of its cycle. */
static int in_cycle(int window, int section)
{
    return window % CYCLE * SECTIONS + section;
}

/* An output, or a derivative of it, on a section of a window, t after the start of its cycle. */
static real value(const model_of *m, const real *series, int window, int section, int output, real t)
{
    const int at = section * NAME_OUTPUTS + output;
    const int degree = m->degree[window];
    real sum = 0;
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        const int s = strand_at[k];
        const int now = window % CYCLE * NAME_STRANDS + s;
        const real u = ((t - strand_start[now]) + strand_excess[now]) * strand_scale[s] - 1;
        sum += series_at(series + m->place[window] + (size_t)s * (size_t)(degree + 2), degree + 1, u);
    }
    return sum;
}

/* Look for the largest value of each output, or nearly: in the middle of sections whose mean is half as much again as
 * that of those looked at, or much more than what was found. What lies beyond TAU_MAX does not count. */
static void look(const model_of *m, const real *series, int window, real *means, real *largest)
{
    const real *const all = series + m->place[window];
    for (int section = 0; section < SECTIONS; ++section) {
        const int here = in_cycle(window, section);
        const real reach = NAME_TAU_MAX - cycle_begin(window);
        const real end = from[here + 1] < reach ? from[here + 1] : reach;
        for (int output = 0; output < NAME_OUTPUTS && from[here] <= end; ++output) {
            const int at = section * NAME_OUTPUTS + output;
            real mean = 0;
            for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
                mean += all[(size_t)strand_at[k] * (size_t)(m->degree[window] + 2)];
            }
            if (2 * magnitude(mean) > 3 * means[output] || magnitude(mean) > 4 * largest[output]) {
                const real middle = from[here] + (end - from[here]) / 2;
                means[output] = larger(means[output], mean);
                largest[output] = larger(largest[output], value(m, series, window, section, output, middle));
            }
        }
    }
}

static real infinity(void)
{
    const volatile real zero = 0;
    return 1 / zero;
}

/* Add what the values of a window's series stay below while they are read; what is no finite number stays in the sum. */
static void weigh(real *sum, const real *all, int degree)
{
    const size_t count = (size_t)NAME_STRANDS * (size_t)(degree + 2);
    slice some = nothing;
    real others = 0;
    size_t k = 0;
    for (; k + LANES <= count; k += LANES) {
        some += MAGNITUDE(*slice_at(all, k));
    }
    for (; k < count; ++k) {
        others += magnitude(all[k]);
    }
    *sum += (real)(4 * (degree + 2)) * (total_of(&some) + others);
}
