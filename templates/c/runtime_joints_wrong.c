/* runtime_joints_wrong.c: what may be wrong of loads and outputs, beside waves.
 * Plain C that stands below the text of runtime_joints_build.c in generated files, which have what stands below the first empty
 * line. */
#include "runtime_joints_build.c"

typedef struct {
    real force[NAME_PANELS][NAME_FORCES + 1]; /* of a load, on this window */
    real total[NAME_HEARD + 1];               /* of an integral */
    real load[NAME_FORCES + 1][3], roundings[NAME_FORCES + 1];
    int since[NAME_FORCES + 1][2];
    real output[NAME_OUTPUTS];
} wrong_beside;

/* What is no number is not known: no bound. */
static real known(real x)
{
    return finite_number(x) ? x : infinity();
}

/* No less than the root. */
static real root(real x)
{
    real y = 1;
    if (!(x > 0) || !finite_number(x)) {
        return x <= 0 ? 0 : infinity();
    }
    while (y < x / y) {
        y *= 2;
    }
    while (y / 4 > x / y) {
        y /= 2;
    }
    for (int k = 0; k < 8; ++k) {
        y = (y + x / y) / 2;
    }
    return y * (1 + 4 * unit);
}

/* No less than the root of the sum of squares. They are taken relative to the largest, as those of what is far from 1 are
 * beyond all numbers, or nothing. */
static real norm(const real *x, int count)
{
    real most = 0, sum = 0;
    for (int k = 0; k < count; ++k) {
        most = larger(most, known(x[k]));
    }
    if (count < 2 || !(most > 0) || !finite_number(most)) {
        return most;
    }
    for (int k = 0; k < count; ++k) {
        sum += (x[k] / most) * (x[k] / most);
    }
    return most * root(sum);
}

/* Nothing, at first. */
static void begun_beside(wrong_beside *w)
{
    for (int k = 0; k <= NAME_HEARD; ++k) {
        w->total[k] = 0;
    }
    for (int f = 0; f <= NAME_FORCES; ++f) {
        w->load[f][0] = w->load[f][1] = w->load[f][2] = 0;
        w->roundings[f] = roundings + 4;
        w->since[f][0] = w->since[f][1] = 0;
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            w->force[panel][f] = 0;
        }
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        w->output[output] = 0;
    }
}

/* As press, with the absolute values of all that is added. */
static int pressed(wrong_beside *w, const real *change, int window, int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        while (event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel) {
            const int f = event_force[event];
            real *const c = w->load[f];
            const real gone = (real)(window - w->since[f][0] + 1) * window_length;
            c[0] += gone * (c[1] + gone * c[2]);
            c[1] += 2 * gone * c[2];
            c[event_power[event] % 3] += magnitude(change[event]);
            w->since[f][0] = window;
            w->since[f][1] = panel;
            w->roundings[f] += 8;
            ++event;
        }
        for (int f = 0; f < NAME_FORCES; ++f) {
            const real *const c = w->load[f];
            const real gone = (real)(window - w->since[f][0] + 2) * window_length;
            w->force[panel][f] = (w->roundings[f] + 12) * unit * (c[0] + 2 * gone * (c[1] + 2 * gone * c[2]));
        }
    }
    return event;
}
