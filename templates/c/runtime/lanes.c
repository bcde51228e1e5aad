/* lanes.c: numbers of many sets of parameters, a set in each lane of a vector: loads, integrals.
 * Plain C where there is no GNU C, one set at a time. Stands above the text of a march in lanes in generated files, which
 * have what stands below the first empty line. */
#ifndef NAME_JOINTED
#include "bounds.c"
#endif

/* All sets have one degree, the highest that one of them needs. A set that is refused goes along as another, or runs
 * wild in its own lane. */
typedef name_batch batch_of;
typedef name_wide wide;

#if defined(NAME_VECTORS)
static const wide none = {0};
typedef __typeof__(none < none) mask;
#define LANE(x, set) ((x)[set])
#define CHOSEN(test, one, other) ((wide)(((test) & (mask)(one)) | (~(test) & (mask)(other))))
#else
static const wide none = 0;
typedef int mask;
#define LANE(x, set) (x)
#define CHOSEN(test, one, other) ((test) ? (one) : (other))
#endif

#define NOWHERE (none < none)

/* `most` grows to the magnitude of x */
static void enlarge_batch(wide *most, const wide *x)
{
    const wide size = MAGNITUDE(*x);
    const mask more = size > *most;
    *most = CHOSEN(more, size, *most);
}

/* Whether a test holds in some set. */
static int in_some(const mask *test)
{
    int found = 0;
    (void)test;
    for (int set = 0; set < NAME_WIDTH; ++set) {
        found |= LANE(*test, set) != 0;
    }
    return found;
}

/* As press. */
static int press_batch(batch_of *b, int window, int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        while (event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel) {
            const int f = event_force[event];
            wide *const c = b->load[f];
            const real gone =
                (real)(window - b->since[f][0]) * window_length + since_panel[panel * NAME_PANELS + b->since[f][1]];
            c[0] += gone * (c[1] + gone * c[2]);
            c[1] += 2 * gone * c[2];
            for (int k = 0; k < 3 && event_power[event] >= 3; ++k) {
                c[k] = none;
            }
            c[event_power[event] % 3] += b->change[event];
            b->since[f][0] = window;
            b->since[f][1] = panel;
            ++event;
        }
        const real half = half_length[panel];
        for (int f = 0; f < NAME_FORCES; ++f) {
            const wide *const c = b->load[f];
            const real gone =
                (real)(window - b->since[f][0]) * window_length + since_panel[panel * NAME_PANELS + b->since[f][1]];
            const real middle = gone + half;
            b->force[panel][f][0] = (c[0] + middle * c[1]) + (middle * middle + half * half / 2) * c[2];
            b->force[panel][f][1] = half * (c[1] + 2 * middle * c[2]);
            b->force[panel][f][2] = half * half / 2 * c[2];
        }
    }
    return event;
}

/* As integrate, and times half the length of the panel. */
static void integrate_batch(const batch_of *b, const wide *w, int degree, real half, wide *c)
{
    c[0] = none;
    c[1] = half * (degree > 1 ? w[0] - w[2] / 2 : w[0]);
    for (int k = 2; k < degree; ++k) {
        c[k] = (w[k - 1] - w[k + 1]) * (half * b->inverse[k]);
    }
    c[degree] = w[degree - 1] * (half * b->inverse[degree]);
    c[degree + 1] = w[degree] * (half * b->inverse[degree + 1]);
}

/* As end_value. */
static void end_value_batch(const wide *c, int degree, real u, wide *value)
{
    wide next = none, after = none;
    if (u > -1 && u < 1 && (u < 0 || u > 0)) {
        for (int k = degree; k > 0; --k) {
            const wide now = (2 * u * next - after) + c[k];
            after = next;
            next = now;
        }
        *value = (u * next - after) + c[0];
        return;
    }
    const int by = u < 0 || u > 0 ? 1 : 2;
    for (int k = 0; k <= degree; k += 2 * by) {
        next += c[k];
        after += k + by <= degree ? c[k + by] : none;
    }
    *value = u > 0 ? next + after : next - after;
}
