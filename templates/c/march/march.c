/* march.c: waves window by window. */
#include "tables.h"
#include "../series.h"
#include "../joint.c"

/* All delays are multiples of one step, so what arrives at a joint on a window (one step long) was sent on
 * a window before, and each joint needs to know no more. A window is cut into panels at the instants of loads; on a panel
 * waves are Chebyshev series in u, -1 <= u <= 1. A track is what is sent into an end of a bar.
 *
 * A joint without state scatters: a matrix makes what it sends of what arrives. The others have velocities q of their
 * points and send ratio q - a; where a arrives, push a acts. A body, one mass without springs, solves
 *
 *     q'/rate + q = p,    p = drive load + the sum of push a:
 *
 * integrated once, with q_0 and p_0 counted twice, this is q_k + x_k (q_(k-1) - q_(k+1)) = x_k (p_(k-1) - p_(k+1));
 * slack, ratios, loss, first and last are its elimination. A block, any other joint with a state x (velocities of masses,
 * lengthening of springs), has a matrix for each panel:
 * (coefficients of what acts on its points, x at the start) -> (those of the velocities q, x at the end less x). */

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
static real read_wave(const march *state, int number, int late, real t)
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
static real integral_of_wave(const march *state, int number, int late, real t, int whole)
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
    for (int k = first_term[output]; k < first_term[output + 1]; ++k) {
        if (summed[k]) {
            sum += gain[k] * integral_of_wave(state, track[k], delay[k], t, whole);
        }
    }
    return sum;
}

static void read_at(const march *state, real t, real out[OUTPUTS])
{
    for (int output = 0; output < OUTPUTS; ++output) {
        out[output] = integral(state, output, t, 0);
        for (int k = first_term[output]; k < first_term[output + 1]; ++k) {
            if (!summed[k]) {
                out[output] += gain[k] * read_wave(state, track[k], delay[k], t);
            }
        }
    }
}

/* The changes of the loads at the start of a panel. */
static void change_loads(march *state, int panel)
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

/* A joint on a panel of the current window. */
static BY_ITSELF void advance_joint(march *state, int joint, int panel, const real *acting)
{
    const int first = first_port[joint];
    joint_on_panel on = no_ends;
    real given[WIDEST + 1];
    real velocities[WIDEST];
    on.table = matrix + answer[panel * JOINTS + joint];
    on.pushes = push + first;
    on.driven = drive[joint];
    for (int port = first; port < first_port[joint + 1]; ++port) {
        on.arriving[port - first] = wave(state, arrive[port], steps[arrive[port]], panel);
        on.sent[port - first] = wave_sent(state, send[port], panel);
    }
    step_joint(joint, &on, acting, state->x + first_state[joint], given, velocities);
}

/* The window that has just been made known. */
static void advance(march *state)
{
    for (int panel = 0; panel < PANELS; ++panel) {
        real acting[(FORCES + 1) * POWERS] = {0};
        change_loads(state, panel);
        for (int force = 0; force < FORCES; ++force) {
            const int *const then = state->changed[force];
            const real half = half_length[panel];
            const real middle = ((real)(state->window - then[0]) * step + since[panel * PANELS + then[1]]) + half;
            load_series(state->load[force], middle, half, acting + force * POWERS);
        }
        for (int joint = 0; joint < JOINTS; ++joint) {
            advance_joint(state, joint, panel, acting);
        }
    }
}

static void start_march(march *state)
{
    state->window = 0;
    state->event = 0;
    for (int k = 0; k < STATES; ++k) {
        state->x[k] = initial_state[k];
    }
    clear(state->total, OUTPUTS);
    for (int force = 0; force < FORCES; ++force) {
        clear(state->load[force], 3);
        state->changed[force][0] = 0;
        state->changed[force][1] = 0;
    }
    for (int k = 0; k < TRACKS; ++k) {
        for (int slot = ring[k]; slot <= ring[k] + steps[k]; ++slot) {
            for (int panel = 0; panel < PANELS; ++panel) {
                clear(state->waves[slot][panel], SIZE);
                state->waves[slot][panel][0] = held[k];
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
    start_march(&state);
    outputs_at(&state, tau, out);
    return 0;
}

int name_sample(real tau0, real dtau, size_t count, real *out)
{
    march state;
    int outside = 0;
    start_march(&state);
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
