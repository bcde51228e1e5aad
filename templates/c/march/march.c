/* march.c: waves window by window.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "tables.h"
#include "../series.h"

/* False for what is no number. */
static int within_reach(real x)
{
    return x >= -reach && x <= reach;
}

static real magnitude(real x)
{
    return x < 0 ? -x : x;
}

/* What is heard, where it arrives, t after the start of the window. */
static real arrived(const march *state, int heard, real t)
{
    int s = first_stretch[delay[heard]];
    while (s + 1 < first_stretch[delay[heard] + 1] && t >= from[s + 1]) {
        ++s;
    }
    const int half = back[s] ? !state->half : state->half;
    const real w = (t - start[s]) + excess[s];
    return series(state->waves[half][way[heard]][panel_of[s]][sender[heard] + 1], w / half_length[panel_of[s]] - 1);
}

/* Its integral from the start of the window to t after it, 0 <= t <= 1. */
static real gathered(const march *state, int heard, real t)
{
    const int begin = first_stretch[delay[heard]];
    const int end = first_stretch[delay[heard] + 1];
    real sum = 0;
    for (int s = begin; s < end && (s == begin || t >= from[s]); ++s) {
        const int half = back[s] ? !state->half : state->half;
        const real *const wave = state->waves[half][way[heard]][panel_of[s]][sender[heard] + 1];
        const real length = half_length[panel_of[s]];
        const int ends = s + 1 < end && t >= from[s + 1];
        const real low = s == begin ? excess[s] - start[s] : (real)0;
        const real high = ends ? 2 * length : (t - start[s]) + excess[s];
        sum += length * (antiderivative(wave, high / length - 1) - antiderivative(wave, low / length - 1));
    }
    return sum;
}

/* The integrals in an output. */
static real displaced(const march *state, int output, real t)
{
    real sum = 0;
    for (int k = first_heard[output]; k < first_heard[output + 1]; ++k) {
        if (summed[k]) {
            sum += gain[k] * gathered(state, k, t);
        }
    }
    return state->displacement[output] + sum;
}

static real value(const march *state, int output, real t)
{
    real sum = 0;
    for (int k = first_heard[output]; k < first_heard[output + 1]; ++k) {
        if (!summed[k]) {
            sum += gain[k] * arrived(state, k, t);
        }
    }
    return displaced(state, output, t) + sum;
}

/* The scene's own loads on a panel, as series. */
static void own(march *state, int panel, real force[FORCES + 1][SIZE])
{
    const real half = half_length[panel];
    for (int f = 0; f <= FORCES; ++f) {
        const real *const c = state->load[f];
        const int *const from_then = state->since[f];
        const real middle = ((real)(state->window - from_then[0]) + since[panel * PANELS + from_then[1]]) + half;
        force[f][0] = (c[0] + middle * c[1]) + (middle * middle + half * half / 2) * c[2];
        force[f][1] = half * (c[1] + 2 * middle * c[2]);
        force[f][2] = half * half / 2 * c[2];
        for (int k = 3; k <= DEGREE; ++k) {
            force[f][k] = 0;
        }
    }
}

/* What a load has left at the highest degrees, more than rounding: it is too rough for its points. */
static real roughness(const real *values, const real *c)
{
    real largest = 0;
    for (int k = 0; k <= DEGREE; ++k) {
        largest = magnitude(values[k]) > largest ? magnitude(values[k]) : largest;
    }
    const real rough = (magnitude(c[DEGREE]) + magnitude(c[DEGREE - 1])) - noise * largest;
    return rough > 0 ? rough : 0;
}

/* Loads given at the points of a panel, as series: c_k = 2/DEGREE sum of values times T_k, halves at both ends. */
static void given(march *state, int panel, const real *loads, real force[FORCES + 1][SIZE])
{
    for (int f = 0; f <= FORCES; ++f) {
        for (int k = 0; k <= DEGREE; ++k) {
            force[f][k] = 0;
        }
    }
    for (int s = 0; s < SOURCES; ++s) {
        const real *const values = loads + s * NAME_POINTS + panel * SIZE;
        real c[SIZE + 1];
        for (int k = 0; k <= DEGREE; ++k) {
            real sum = 0;
            for (int j = 0; j <= DEGREE; ++j) {
                const int turn = (int)((long)j * k % (2 * DEGREE));
                const real term = values[DEGREE - j] * cosine[turn <= DEGREE ? turn : 2 * DEGREE - turn];
                sum += j == 0 || j == DEGREE ? term / 2 : term;
            }
            c[k] = (k == 0 || k == DEGREE ? sum : 2 * sum) / (real)DEGREE;
        }
        c[SIZE] = 0;
        const real rough = magnitude(source_gain[s]) * roughness(values, c);
        state->rough = rough > state->rough ? rough : state->rough;
        real *const on = force[source_force[s]];
        if (source_integral[s]) {
            const real half = half_length[panel];
            const real before = antiderivative(c, -1);
            on[0] += source_gain[s] * (state->integral[s] - half * before);
            for (int k = 1; k <= DEGREE; ++k) {
                on[k] += source_gain[s] * (half * ((k == 1 ? 2 * c[0] : c[k - 1]) - c[k + 1]) / (real)(2 * k));
            }
            state->integral[s] += half * (antiderivative(c, 1) - before);
        } else {
            add(on, source_gain[s], c, SIZE);
        }
    }
}

/* The velocity q of a body on a panel; `velocity` goes from its start to its end. What the polynomial misses. */
static real moved(int row, const real p[SIZE + 1], real q[SIZE], real *velocity)
{
    const real *const e = ratio + row * SIZE;
    const real *const at_first = first + row * SIZE;
    const real *const at_last = last + row * SIZE;
    real y = 0;
    real begun = 0;
    real ended = 0;
    for (int k = DEGREE; k > 0; --k) {
        y = e[k] * (((k == 1 ? 2 * p[0] : p[k - 1]) - p[k + 1]) + y);
        q[k] = y;
        begun += at_first[k] * y;
        ended += at_last[k] * y;
    }
    begun = *velocity - begun;
    q[0] = begun - slack[row] * begun;
    *velocity = q[0] + (ended - loss[row] * q[0]);
    real before = 2 * q[0];
    for (int k = 1; k <= DEGREE; ++k) {
        before = q[k] - e[k] * before;
        q[k] = before;
    }
    return leak[row] * magnitude(q[DEGREE] - p[DEGREE]);
}

static void watch(march *state, real found)
{
    if (magnitude(found) > state->size) {
        state->size = magnitude(found);
    }
}

void name_init(march *state)
{
    state->window = -1;
    state->half = 0;
    state->within = 1;
    state->alarm = 0;
    state->event = 0;
    state->leak = 0;
    state->size = 0;
    state->rough = 0;
    for (int node = 0; node < NODES; ++node) {
        state->velocity[node] = motion[node];
    }
    for (int output = 0; output < OUTPUTS; ++output) {
        state->displacement[output] = 0;
    }
    for (int s = 0; s <= SOURCES; ++s) {
        state->integral[s] = 0;
    }
    for (int f = 0; f <= FORCES; ++f) {
        for (int power = 0; power < 3; ++power) {
            state->load[f][power] = 0;
        }
        state->since[f][0] = 0;
        state->since[f][1] = 0;
    }
    for (int half = 0; half < 2; ++half) {
        for (int panel = 0; panel < PANELS; ++panel) {
            for (int node = 0; node < NODES + 2; ++node) {
                for (int to = 0; to < WAYS; ++to) {
                    for (int k = 0; k <= DEGREE; ++k) {
                        state->waves[half][to][panel][node][k] = 0;
                    }
                }
                if (node > 0) {
                    state->waves[half][LEFT][panel][node][0] = rod[node - 1];
                }
                if (node <= NODES) {
                    state->waves[half][RIGHT][panel][node][0] = rod[node];
                }
            }
        }
    }
}

/* The changes of the scene's own loads at the start of a panel. */
static void change(march *state, int panel)
{
    while (state->event < EVENTS && event_window[state->event] == state->window &&
           event_panel[state->event] == panel) {
        const int f = event_force[state->event];
        for (int power = 0; power < 3; ++power) {
            state->load[f][power] = event_power[3 * state->event + power];
        }
        state->since[f][0] = state->window;
        state->since[f][1] = panel;
        state->event += 1;
    }
}

/* The next window. Whether all of it is within reach. */
static int marched(march *state, const real *loads)
{
    const int before = state->half;
    int within = 1;
    if (state->window >= 0) {
        for (int output = 0; output < OUTPUTS; ++output) {
            state->displacement[output] = displaced(state, output, 1);
            within &= within_reach(state->displacement[output]);
        }
    }
    state->half = !before;
    state->window += 1;
    for (int panel = 0; panel < PANELS; ++panel) {
        change(state, panel);
        real force[FORCES + 1][SIZE];
        if (loads) {
            given(state, panel, loads, force);
        } else {
            own(state, panel, force);
        }
        for (int to = LOAD; to < WAYS; ++to) {
            for (int f = 0; f < FORCES; ++f) {
                for (int k = 0; k <= DEGREE; ++k) {
                    state->waves[state->half][to][panel][f + 1][k] = force[f][k];
                }
            }
        }
        for (int node = 0; node < NODES; ++node) {
            const real *const a = state->waves[before][RIGHT][panel][node];
            const real *const b = state->waves[before][LEFT][panel][node + 2];
            real *const left = state->waves[state->half][LEFT][panel][node + 1];
            real *const right = state->waves[state->half][RIGHT][panel][node + 1];
            real p[SIZE + 1];
            real q[SIZE];
            for (int k = 0; k <= DEGREE; ++k) {
                p[k] = alpha[node] * a[k] + beta[node] * b[k];
            }
            p[SIZE] = 0;
            if (force_on[node] >= 0) {
                add(p, 1, force[force_on[node]], SIZE);
            }
            const int row = body[panel * NODES + node];
            if (row >= 0) {
                state->leak += moved(row, p, q, &state->velocity[node]);
                watch(state, state->velocity[node]);
                within &= within_reach(state->velocity[node]);
            }
            const real *const sent = row >= 0 ? q : p;
            for (int k = 0; k <= DEGREE; ++k) {
                left[k] = sent[k] - a[k];
                right[k] = sent[k] - b[k];
                within &= within_reach(left[k]) && within_reach(right[k]);
            }
            watch(state, left[0]);
            watch(state, right[0]);
        }
    }
    for (int s = 0; s < SOURCES; ++s) {
        within &= within_reach(state->integral[s]);
    }
    return within;
}

/* Whether loads, and what they make of their nodes, are numbers within reach. */
static int given_within_reach(const real *loads)
{
    for (int s = 0; s < SOURCES; ++s) {
        for (int k = 0; k < NAME_POINTS; ++k) {
            const real load = loads[s * NAME_POINTS + k];
            if (!within_reach(load) || !within_reach(source_gain[s] * load)) {
                return 0;
            }
        }
    }
    return 1;
}

int name_advance(march *state, const real *loads)
{
    if (!state->within || state->window >= LAST_WINDOW || (loads && !given_within_reach(loads))) {
        return 2;
    }
    state->within = marched(state, loads);
    if (!state->within) {
        return 2;
    }
    state->alarm |= state->leak > trusted * state->size || state->rough > smooth * state->size;
    return state->alarm;
}

int name_read(const march *state, real tau, real out[OUTPUTS])
{
    const real t = tau - (real)state->window;
    const int inside = state->within && state->window >= 0 && t >= 0 && t < 1 && tau <= last_tau;
    for (int output = 0; output < OUTPUTS; ++output) {
        out[output] = inside ? value(state, output, t) : not_a_number();
    }
    return !inside;
}

real name_energy(const march *state)
{
    real energy = 0;
    for (int node = 0; node < NODES; ++node) {
        energy += mass[node] * state->velocity[node] * state->velocity[node] / 2;
        for (int direction = 0; direction < 2; ++direction) {
            for (int panel = 0; panel < PANELS; ++panel) {
                const real *const c = state->waves[state->half][direction][panel][node + 1];
                real sum = 0;
                for (int j = 0; j <= DEGREE; ++j) {
                    for (int k = j % 2; k <= DEGREE; k += 2) {
                        const real both = (real)(j + k);
                        const real apart = (real)(j - k);
                        sum += c[j] * c[k] * (1 / (1 - both * both) + 1 / (1 - apart * apart));
                    }
                }
                energy += impedance[node + direction] * half_length[panel] * sum;
            }
        }
    }
    return energy;
}

/* March on to tau and read. */
static int outputs_at(march *state, real tau, real out[OUTPUTS])
{
    int status = 0;
    while (state->window < (int)tau && status < 2) {
        status |= name_advance(state, NULL);
    }
    return (status != 0) | name_read(state, tau, out);
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
    name_init(&state);
    return outputs_at(&state, tau, out);
}

int name_sample(real tau0, real dtau, size_t count, real *out)
{
    march state;
    int outside = 0;
    name_init(&state);
    for (size_t i = 0; i < count; ++i) {
        /* towards later tau, whatever the sign of dtau */
        const size_t k = dtau < 0 ? count - 1 - i : i;
        /* volatile: the product is rounded by itself, so that every compiler means the same tau_k */
        const volatile real step = (real)k * dtau;
        const real tau = tau0 + step;
        real at_tau[OUTPUTS];
        if (tau == tau && tau >= 0 && tau <= NAME_TAU_MAX) {
            outside |= outputs_at(&state, tau, at_tau);
        } else {
            outside |= refuse(at_tau);
        }
        for (size_t output = 0; output < OUTPUTS; ++output) {
            out[output * count + k] = at_tau[output];
        }
    }
    return outside;
}
