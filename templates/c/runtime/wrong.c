/* wrong.c: what may be wrong of loads and of what is read; what bounds of all models start from.
 * Plain C that stands below the text of blocks.c in generated files, which have what stands below the first empty
 * line. */
#include "blocks.c"

typedef struct {
    real force[NAME_PANELS][NAME_FORCES + 1]; /* of a load, on this window */
    real load[NAME_FORCES + 1][3], roundings[NAME_FORCES + 1];
    int since[NAME_FORCES + 1][2];
    real reading[NAME_ROW + LANES]; /* of each coefficient of a wave, what it loses on the way to an output */
    real least;                     /* what the first one loses at the lowest degree */
    int degree;
    real total[NAME_HEARD + 1];     /* of an integral, and how large that is */
    real most[NAME_HEARD + 1];
    real largest[NAME_OUTPUTS]; /* where the mean of an output was large */
    int window[NAME_OUTPUTS];
} wrong_beside;

static const real alternating[17] = {1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1};

/* No less than the root, and hardly more: half the sum of y and x/y is no less, whatever y is. */
static real root(real x)
{
    real y = 1;
    if (!(x > 0) || !finite_number(x)) {
        return x > 0 ? infinity() : 0;
    }
    while (y < x / y) {
        y *= 2;
    }
    while (y / 4 > x / y) {
        y /= 2;
    }
    for (int k = 0; k < 3; ++k) {
        y = (y + x / y) / 2;
    }
    return y * (1 + 4 * unit);
}

/* Nothing, at first. */
static void begun_beside(wrong_beside *w)
{
    w->degree = -1;
    for (int k = 0; k <= NAME_HEARD; ++k) {
        w->total[k] = w->most[k] = 0;
    }
    for (int f = 0; f <= NAME_FORCES; ++f) {
        w->load[f][0] = w->load[f][1] = w->load[f][2] = 0;
        w->roundings[f] = roundings + 8;
        w->since[f][0] = w->since[f][1] = 0;
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            w->force[panel][f] = 0;
        }
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        w->largest[output] = 0;
        w->window[output] = 0;
    }
}

/* A sum that is read loses 12 roundings of a coefficient times (k + 1)(k + 2) + degree; before, it is multiplied by what
 * is rounded, too, and added to others. */
static void begun_reading(wrong_beside *w, int degree)
{
    if (degree > w->degree) {
        for (int k = 0; k < NAME_ROW + LANES; ++k) {
            w->reading[k] = unit * (roundings + (real)(NAME_HEARD + 4 + 12 * degree) + 12 * ((real)k + 1) * ((real)k + 2));
        }
        w->least = w->degree < 0 ? w->reading[0] : w->least;
        w->degree = degree;
    }
}

/* The time since a load changed. */
static real gone_by(const wrong_beside *w, int window, int panel, int f)
{
    return (real)(window - w->since[f][0]) * window_length + since_panel[panel * NAME_PANELS + w->since[f][1]];
}

/* As press, with the absolute values of all that is added. */
static void pressed(wrong_beside *w, const real *change, int window, int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        while (event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel) {
            const int f = event_force[event];
            real *const c = w->load[f];
            const real gone = gone_by(w, window, panel, f);
            c[0] += gone * (c[1] + gone * c[2]);
            c[1] += 2 * gone * c[2];
            for (int k = 0; k < 3 && event_power[event] >= 3; ++k) {
                c[k] = 0;
                w->roundings[f] = roundings + 8;
            }
            c[event_power[event] % 3] += magnitude(change[event]);
            w->since[f][0] = window;
            w->since[f][1] = panel;
            w->roundings[f] += 8;
            ++event;
        }
        for (int f = 0; f < NAME_FORCES; ++f) {
            const real *const c = w->load[f];
            const real gone = gone_by(w, window, panel, f) + 2 * half_length[panel];
            w->force[panel][f] = (w->roundings[f] + 12) * unit * (c[0] + 2 * gone * (c[1] + 2 * gone * c[2]));
        }
    }
}
