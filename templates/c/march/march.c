/* march.c: waves window by window.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "tables.h"
#include "../series.h"

/* A march: `waves` has a ring for each track, its last windows; x are the states of the joints. */
typedef struct march {
    int window;
    int event;
    real x[STATES + 1];
    real total[OUTPUTS];       /* integrals at the start of the window */
    real load[FORCES + 1][3];  /* in powers of the time since */
    int changed[FORCES + 1][2]; /* that window and panel */
    real waves[SLOTS][PANELS][SIZE];
} march;

/* Where a track has the current window. */
static real *wave_sent(march *state, int number, int panel)
{
    return state->waves[ring[number] + state->window % (steps[number] + 1)][panel];
}

/* What a track had so many windows ago, at most as many as it has steps. */
static const real *wave(const march *state, int number, int windows, int panel)
{
    const int turn = steps[number] + 1;
    return state->waves[ring[number] + (state->window + turn - windows) % turn][panel];
}

/* A track where it is heard, t after the start of the cycle. */
static real heard(const march *state, int number, int late, real t)
{
    const int phase = state->window % CYCLE;
    int s = first_stretch[late];
    while (s + 1 < first_stretch[late + 1] && t >= from[(s + 1) * CYCLE + phase]) {
        ++s;
    }
    const real w = (t - start[s * CYCLE + phase]) + excess[s * CYCLE + phase];
    return series(wave(state, number, back[s], panel_of[s]), w / half_length[panel_of[s]] - 1);
}

/* Its integral from the start of the window to t, or over the `whole` of it. */
static real gathered(const march *state, int number, int late, real t, int whole)
{
    const int phase = state->window % CYCLE;
    const int first = first_stretch[late];
    const int end = first_stretch[late + 1];
    real sum = 0;
    for (int s = first; s < end && (s == first || whole || t >= from[s * CYCLE + phase]); ++s) {
        const real *const c = wave(state, number, back[s], panel_of[s]);
        const real half = half_length[panel_of[s]];
        const int over = whole || (s + 1 < end && t >= from[(s + 1) * CYCLE + phase]);
        const real until = over ? high[s] : (t - start[s * CYCLE + phase]) + excess[s * CYCLE + phase];
        sum += half * (antiderivative(c, until / half - 1) - antiderivative(c, low[s] / half - 1));
    }
    return sum;
}

/* The integrals in an output. */
static real integral(const march *state, int output, real t, int whole)
{
    real sum = state->total[output];
    for (int k = first_heard[output]; k < first_heard[output + 1]; ++k) {
        if (summed[k]) {
            sum += gain[k] * gathered(state, track[k], delay[k], t, whole);
        }
    }
    return sum;
}

static void read_at(const march *state, real t, real out[OUTPUTS])
{
    for (int output = 0; output < OUTPUTS; ++output) {
        out[output] = integral(state, output, t, 0);
        for (int k = first_heard[output]; k < first_heard[output + 1]; ++k) {
            if (!summed[k]) {
                out[output] += gain[k] * heard(state, track[k], delay[k], t);
            }
        }
    }
}

/* What acts on a point on a panel: three coefficients. */
static void acts(const march *state, int force, int panel, real *c)
{
    const real *const power = state->load[force];
    const int *const then = state->changed[force];
    const real half = half_length[panel];
    const real middle = ((real)(state->window - then[0]) * step + since[panel * PANELS + then[1]]) + half;
    c[0] = (power[0] + middle * power[1]) + (middle * middle + half * half / 2) * power[2];
    c[1] = half * (power[1] + 2 * middle * power[2]);
    c[2] = half * half / 2 * power[2];
}

/* The changes of the loads at the start of a panel. */
static void change(march *state, int panel)
{
    while (state->event < EVENTS && event_window[state->event] == state->window &&
           event_panel[state->event] == panel) {
        const int force = event_force[state->event];
        for (int power = 0; power < 3; ++power) {
            state->load[force][power] = event_power[3 * state->event + power];
        }
        state->changed[force][0] = state->window;
        state->changed[force][1] = panel;
        state->event += 1;
    }
}

/* A body on a panel: from p and its velocity at the start that at the end, and its own. */
static void step_body(march *state, int joint, int panel)
{
    const real *const e = matrix + answer[panel * JOINTS + joint];
    const real *const at_first = e + SIZE;
    const real *const at_last = e + 2 * SIZE;
    real *const x = state->x + first_state[joint];
    const int force = force_on[first_point[joint]];
    const int first = first_port[joint];
    const int end = first_port[joint + 1];
    real p[SIZE + 1];
    real q[SIZE];
    const real *const arrived = wave(state, arrive[first], steps[arrive[first]], panel);
    for (int k = 0; k < SIZE; ++k) {
        p[k] = push[first] * arrived[k];
    }
    p[SIZE] = 0;
    for (int port = first + 1; port < end; ++port) {
        add(p, push[port], wave(state, arrive[port], steps[arrive[port]], panel), SIZE);
    }
    if (force >= 0) {
        real c[3];
        acts(state, force, panel, c);
        add(p, drive[joint], c, 3);
    }
    real y = 0;
    real begun_at = 0;
    real ended_at = 0;
    for (int k = DEGREE; k > 0; --k) {
        y = e[k] * (((k == 1 ? 2 * p[0] : p[k - 1]) - p[k + 1]) + y);
        q[k] = y;
        begun_at += at_first[k] * y;
        ended_at += at_last[k] * y;
    }
    begun_at = *x - begun_at;
    q[0] = begun_at - e[0] * begun_at;
    *x = q[0] + (ended_at - at_first[0] * q[0]);
    real before = 2 * q[0];
    for (int k = 1; k <= DEGREE; ++k) {
        before = q[k] - e[k] * before;
        q[k] = before;
    }
    for (int port = first; port < end; ++port) {
        const real *const a = wave(state, arrive[port], steps[arrive[port]], panel);
        real *const out = wave_sent(state, send[port], panel);
        for (int k = 0; k < SIZE; ++k) {
            out[k] = ratio[port] * q[k] - a[k];
        }
    }
}

/* A block on a panel: from what acts on its points, and x at the start, their velocities, and x on. */
static void step_block(march *state, int joint, int panel)
{
    const int points = first_point[joint + 1] - first_point[joint];
    const int states = first_state[joint + 1] - first_state[joint];
    const int width = points * SIZE + states;
    const real *const columns = matrix + answer[panel * JOINTS + joint];
    real *const x = state->x + first_state[joint];
    real given[WIDEST];
    real found[WIDEST];
    for (int k = 0; k < width; ++k) {
        given[k] = k < points * SIZE ? (real)0 : x[k - points * SIZE];
        found[k] = 0;
    }
    for (int point = 0; point < points; ++point) {
        const int force = force_on[first_point[joint] + point];
        if (force >= 0) {
            acts(state, force, panel, given + point * SIZE);
        }
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        add(given + point_of[port] * SIZE, push[port], wave(state, arrive[port], steps[arrive[port]], panel), SIZE);
    }
    for (int k = 0; k < width; ++k) {
        add(found, given[k], columns + k * width, width);
    }
    for (int k = 0; k < states; ++k) {
        x[k] += found[points * SIZE + k];
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const real *const a = wave(state, arrive[port], steps[arrive[port]], panel);
        const real *const q = found + point_of[port] * SIZE;
        real *const out = wave_sent(state, send[port], panel);
        for (int k = 0; k < SIZE; ++k) {
            out[k] = ratio[port] * q[k] - a[k];
        }
    }
}

/* A joint without state: what it sends is a sum of what arrives and acts. */
static void scatter(march *state, int joint, int panel)
{
    const int first = first_port[joint];
    const int end = first_port[joint + 1];
    const real *factor = matrix + answer[panel * JOINTS + joint];
    for (int port = first; port < end; ++port) {
        real *const out = wave_sent(state, send[port], panel);
        for (int k = 0; k < SIZE; ++k) {
            out[k] = 0;
        }
    }
    for (int port = first; port < end; ++port) {
        const real *const a = wave(state, arrive[port], steps[arrive[port]], panel);
        for (int other = first; other < end; ++other) {
            add(wave_sent(state, send[other], panel), *factor++, a, SIZE);
        }
    }
    for (int point = first_point[joint]; point < first_point[joint + 1]; ++point) {
        real c[3] = {0, 0, 0};
        if (force_on[point] >= 0) {
            acts(state, force_on[point], panel, c);
        }
        for (int other = first; other < end; ++other) {
            add(wave_sent(state, send[other], panel), *factor++, c, 3);
        }
    }
}

/* The window that has just been made known. */
static void advance(march *state)
{
    for (int panel = 0; panel < PANELS; ++panel) {
        change(state, panel);
        for (int joint = 0; joint < JOINTS; ++joint) {
            if (BODIES > 0 && law[joint] == BODY) {
                step_body(state, joint, panel);
            } else if (BLOCKS > 0 && law[joint] == BLOCK) {
                step_block(state, joint, panel);
            } else {
                scatter(state, joint, panel);
            }
        }
    }
}

static void begin_march(march *state)
{
    state->window = 0;
    state->event = 0;
    for (int k = 0; k < STATES; ++k) {
        state->x[k] = begun[k];
    }
    for (int output = 0; output < OUTPUTS; ++output) {
        state->total[output] = 0;
    }
    for (int force = 0; force < FORCES; ++force) {
        for (int power = 0; power < 3; ++power) {
            state->load[force][power] = 0;
        }
        state->changed[force][0] = 0;
        state->changed[force][1] = 0;
    }
    for (int k = 0; k < TRACKS; ++k) {
        for (int slot = ring[k]; slot <= ring[k] + steps[k]; ++slot) {
            for (int panel = 0; panel < PANELS; ++panel) {
                for (int power = 0; power < SIZE; ++power) {
                    state->waves[slot][panel][power] = power == 0 ? held[k] : (real)0;
                }
            }
        }
    }
    advance(state);
}

/* March on to tau and read. */
static void outputs_at(march *state, real tau, real out[OUTPUTS])
{
    int cycle = (int)(tau / span);
    if ((real)cycle * span > tau) {
        --cycle;
    }
    const real t = tau - (real)cycle * span;
    int phase = t > 0 ? (int)(t / step) : 0;
    phase = phase < CYCLE ? phase : CYCLE - 1;
    while (phase > 0 && t < begin[phase]) {
        --phase;
    }
    while (phase + 1 < CYCLE && t >= begin[phase + 1]) {
        ++phase;
    }
    while (state->window < cycle * CYCLE + phase) {
        for (int output = 0; output < OUTPUTS; ++output) {
            state->total[output] = integral(state, output, 0, 1);
        }
        state->window += 1;
        advance(state);
    }
    read_at(state, t, out);
}

static int refuse(real out[OUTPUTS])
{
    for (int output = 0; output < OUTPUTS; ++output) {
        out[output] = not_a_number();
    }
    return 1;
}

int name_eval(real tau, real out[OUTPUTS])
{
    march state;
    if (!(tau == tau && tau >= 0 && tau <= NAME_TAU_MAX)) {
        return refuse(out);
    }
    begin_march(&state);
    outputs_at(&state, tau, out);
    return 0;
}

int name_sample(real tau0, real dtau, size_t count, real *out)
{
    march state;
    int outside = 0;
    begin_march(&state);
    for (size_t i = 0; i < count; ++i) {
        /* towards later tau, whatever the sign of dtau */
        const size_t k = dtau < 0 ? count - 1 - i : i;
        /* volatile: the product is rounded by itself, so that every compiler means the same tau_k */
        const volatile real distance = (real)k * dtau;
        const real tau = tau0 + distance;
        real at_tau[OUTPUTS];
        if (tau == tau && tau >= 0 && tau <= NAME_TAU_MAX) {
            outputs_at(&state, tau, at_tau);
        } else {
            outside |= refuse(at_tau);
        }
        for (size_t output = 0; output < OUTPUTS; ++output) {
            out[output * count + k] = at_tau[output];
        }
    }
    return outside;
}
