/* stream.c: waves under loads that come sample by sample, panel by panel.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "tables.h"
#include "../series.h"

/* What a track sent so many panels ago: its own ring, which begins where those of the tracks before end. */
static const real *wave(const stream *state, int number, int panels)
{
    const int slot = state->at[number] - panels;
    return state->waves[first_slot[number] + (slot < 0 ? slot + slots[number] : slot)];
}

static real *wave_sent(stream *state, int number)
{
    return state->waves[first_slot[number] + state->at[number]];
}

static real absolute(real x)
{
    return x < 0 ? -x : x;
}

/* Of a positive number that is finite: the root of a number from 1/4 to 4, by Newton, times a power of 2. */
static real root(real square)
{
    real power = 1;
    real near = 1;
    while (square > 4) {
        square /= 4;
        power *= 2;
    }
    while (square < (real)0.25) {
        square *= 4;
        power /= 2;
    }
    for (int k = 0; k < 6; ++k) {
        near = (near + square / near) / 2;
    }
    return power * near;
}

/* A polynomial will miss so much. What is sent on a panel of a window is felt on that panel of others: all other panels
 * know nothing of it. Squares are those of parts of the largest: they neither vanish nor overflow. */
static void lose(stream *state, real much)
{
    real *const missed = state->missed + state->phase;
    const real more = absolute(much);
    if (!(more <= state->most)) {
        const real part = state->most / more;
        for (int k = 0; k < NAME_PANELS; ++k) {
            state->missed[k] *= part * part;
        }
        state->lost *= part * part;
        state->most = more;
    }
    if (more > 0) {
        const real part = more / state->most;
        *missed += part * part;
        state->lost = *missed > state->lost ? *missed : state->lost;
    }
}

/* y += M a, M by rows */
static void multiply(real *y, const real *rows, const real *a, int height, int width)
{
    for (int k = 0; k < height; ++k) {
        for (int j = 0; j < width; ++j) {
            y[k] += rows[k * width + j] * a[j];
        }
    }
}

/* The integral of a wave from one time in its panel to another. */
static real gathered(const real *c, real from, real to)
{
    return (antiderivative(c, to * scale - 1) - antiderivative(c, from * scale - 1)) / scale;
}

/* What a wave that is heard so late adds up to from the start of the current panel to t. */
static real integral(const stream *state, int k, real t)
{
    const real early = t < rest[k] ? t : rest[k];
    real sum = gathered(wave(state, track[k], late[k]), 0, t - early);
    if (early > 0) {
        sum += gathered(wave(state, track[k], late[k] + 1), panel - rest[k], panel - rest[k] + early);
    }
    return sum;
}

static real value(const stream *state, int k)
{
    const real t = state->time - rest[k];
    const real *const c = t < 0 ? wave(state, track[k], late[k] + 1) : wave(state, track[k], late[k]);
    return series(c, (t < 0 ? t + panel : t) * scale - 1);
}

/* A joint with a state on the panel that begins, without loads: from what arrives, and its state, what it sends. */
static void move(stream *state, int joint)
{
    const int points = first_point[joint + 1] - first_point[joint];
    const int states = first_state[joint + 1] - first_state[joint];
    const int width = points * SIZE + states;
    const real *const columns = matrix + answer[joint];
    real *const x = state->x + first_state[joint];
    real given[WIDEST];
    real found[WIDEST];
    real missed[MOST_JOINED] = {0};
    for (int k = 0; k < width; ++k) {
        given[k] = k < points * SIZE ? (real)0 : x[k - points * SIZE];
        found[k] = 0;
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        add(given + point_of[port] * SIZE, push[port], wave(state, arrive[port], slots[arrive[port]] - 1), SIZE);
    }
    for (int k = 0; k < width; ++k) {
        add(found, given[k], columns + k * width, width);
    }
    for (int k = 0; k < states; ++k) {
        x[k] += found[points * SIZE + k];
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const real *const a = wave(state, arrive[port], slots[arrive[port]] - 1);
        const real *const q = found + point_of[port] * SIZE;
        real *const out = wave_sent(state, send[port]);
        for (int k = 0; k < SIZE; ++k) {
            out[k] = ratio[port] * q[k] - a[k];
        }
    }
    multiply(missed, slip + first_slip[joint], given, points, width);
    for (int k = 0; k < points; ++k) {
        lose(state, missed[k]);
    }
}

/* One without: what it sends is a sum of what arrives. */
static void scatter(stream *state, int joint)
{
    const int first = first_port[joint];
    const int end = first_port[joint + 1];
    const real *factor = matrix + answer[joint];
    for (int port = first; port < end; ++port) {
        real *const out = wave_sent(state, send[port]);
        for (int k = 0; k < SIZE; ++k) {
            out[k] = 0;
        }
    }
    for (int port = first; port < end; ++port) {
        const real *const a = wave(state, arrive[port], slots[arrive[port]] - 1);
        for (int other = first; other < end; ++other) {
            add(wave_sent(state, send[other]), *factor++, a, SIZE);
        }
    }
}

/* A panel begins: all that arrives on it is known, and what joints make of that follows. */
static void begin(stream *state)
{
    state->seen = 0;
    state->phase = state->phase + 1 < NAME_PANELS ? state->phase + 1 : 0;
    for (int joint = 0; joint < JOINTS; ++joint) {
        if (first_state[joint] < first_state[joint + 1]) {
            move(state, joint);
        } else {
            scatter(state, joint);
        }
    }
}

/* It is over: what loads have done is a polynomial now, and is sent as well. */
static void finish(stream *state)
{
    for (int n = 0; n < LOADED; ++n) {
        const int joint = loaded[n];
        real *const x = state->x + first_state[joint];
        real *const own = state->own + first_state[joint];
        for (int point = first_own[n]; point < first_own[n + 1]; ++point) {
            real c[SIZE] = {0};
            multiply(c, transform, state->recorded[point], SIZE, SIZE);
            for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
                if (point_of[port] == point - first_own[n]) {
                    add(wave_sent(state, send[port]), ratio[port], c, SIZE);
                }
            }
            state->moved[point] = 0;
        }
        for (int k = 0; k < first_state[joint + 1] - first_state[joint]; ++k) {
            x[k] += own[k];
            own[k] = 0;
        }
    }
    for (int output = 0; output < OUTPUTS; ++output) {
        for (int k = first_heard[output]; k < first_heard[output + 1]; ++k) {
            if (summed[k]) {
                state->total[output] += gain[k] * integral(state, k, panel);
            }
        }
    }
    for (int k = 0; k < TRACKS; ++k) {
        const real mean = absolute(wave_sent(state, k)[0]);
        state->size = slots[k] > 1 && mean > state->size ? mean : state->size;
        state->at[k] = state->at[k] + 1 < slots[k] ? state->at[k] + 1 : 0;
    }
}

/* What forces are with these loads; integrals of loads stay. */
static void press(stream *state, const real *load)
{
    for (int force = 0; force < FORCES; ++force) {
        if (!integrated[force]) {
            state->force[force] = base[force];
            for (int j = 0; j < LOADS; ++j) {
                state->force[force] += strength[force * LOADS + j] * load[j];
            }
        }
    }
}

/* What loads do to a joint in a time in which forces are s_0 + s_1 v + s_2 v^2, v from 0 to 1: a power series in v. */
static void drive(stream *state, int n, real from, real length, const real *s)
{
    const int joint = loaded[n];
    const int states = first_state[joint + 1] - first_state[joint];
    const int points = first_point[joint + 1] - first_point[joint];
    const real *const rates = law + first_law[n];
    const real *const pushed = rates + states * states;
    const real *const shown = pushed + states * points;
    const real *const passed = shown + points * states;
    real *const own = state->own + first_state[joint];
    real x[MOST_STATES] = {0};
    real q[MOST_POINTS][TERMS + 1];
    for (int a = 0; a < states; ++a) {
        x[a] = own[a];
    }
    for (int power = 0; power <= TERMS; ++power) {
        real next[MOST_STATES];
        for (int a = 0; a < states; ++a) {
            next[a] = 0;
        }
        for (int point = 0; point < points; ++point) {
            q[point][power] = 0;
        }
        multiply(next, rates, x, states, states);
        for (int point = 0; point < points; ++point) {
            const int force = force_on[first_point[joint] + point];
            const real now = force >= 0 && power < 3 ? s[3 * force + power] : (real)0;
            for (int a = 0; a < states; ++a) {
                q[point][power] += shown[point * states + a] * x[a];
                next[a] += pushed[a * points + point] * now;
            }
            for (int other = 0; other < points; ++other) {
                q[other][power] += passed[other * points + point] * now;
            }
        }
        for (int a = 0; a < states; ++a) {
            x[a] = next[a] * (length / (real)(power + 1));
            own[a] += x[a];
        }
    }
    for (int point = 0; point < points; ++point) {
        real sum = 0;
        for (int power = TERMS; power >= 0; --power) {
            sum += q[point][power] / (real)(power + 1);
        }
        state->moved[first_own[n] + point] += length * sum;
        for (int k = state->seen; k < SIZE && instant[k] <= from + length; ++k) {
            const real v = (instant[k] - from) / length;
            sum = 0;
            for (int power = TERMS; power >= 0; --power) {
                sum = sum * v + q[point][power];
            }
            state->recorded[first_own[n] + point][k] = sum;
        }
    }
}

/* Go on by `span` within a panel, while loads go straight to `load`: in parts in which nothing changes too much. */
static void carry(stream *state, real span, const real *load)
{
    const int parts = 1 + (int)(span * fastest);
    const real part = span / (real)parts;
    for (int i = 0; i < parts; ++i) {
        const real from = state->time + (real)i * part;
        real s[3 * FORCES + 1];
        for (int force = 0; force < FORCES; ++force) {
            real now = 0;
            real gained = 0;
            for (int j = 0; j < LOADS; ++j) {
                const real change = (load[j] - state->load[j]) / (real)(parts - i);
                now += strength[force * LOADS + j] * state->load[j];
                gained += strength[force * LOADS + j] * change;
            }
            s[3 * force] = state->force[force];
            s[3 * force + 1] = integrated[force] ? part * now : gained;
            s[3 * force + 2] = integrated[force] ? part * gained / 2 : (real)0;
            state->force[force] += s[3 * force + 1] + s[3 * force + 2];
        }
        for (int n = 0; n < LOADED; ++n) {
            drive(state, n, from, part, s);
        }
        for (int j = 0; j < LOADS; ++j) {
            state->load[j] += (load[j] - state->load[j]) / (real)(parts - i);
        }
        while (state->seen < SIZE && instant[state->seen] <= from + part) {
            state->seen += 1;
        }
    }
    for (int j = 0; j < LOADS; ++j) {
        state->load[j] = load[j];
    }
    press(state, load);
}

/* How wrong a polynomial will be near a change of a load inside of the panel: of a jump, of a kink, of a bend of 1. */
static void blurs(const stream *state, real *blur)
{
    const int n = state->seen;
    if (n > 0 && n < SIZE) {
        for (int order = 0; order < 3; ++order) {
            blur[order] = kink[order * DEGREE + n - 1];
        }
    } else {
        /* between an edge and the instant next to it nothing is seen of it but there */
        const real away = n == 0 ? state->time : panel - state->time;
        blur[0] = away / instant[0] < 1 ? away / instant[0] : (real)1;
        blur[1] = away;
        blur[2] = away * away / 2;
    }
}

/* Whether a point of a joint sends into a rod, and is not only looked at. */
static int sends(int joint, int point)
{
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        if (point_of[port] == point && slots[send[port]] > 1) {
            return 1;
        }
    }
    return 0;
}

/* Loads jump and bend now; what of that polynomials will miss. */
static void bend(stream *state, real dtau, const real *jump, const real *turn)
{
    const real span = dtau > 0 && dtau < panel ? dtau : panel;
    const real whole[3] = {1, span, span * panel}; /* a load bends for this step, and stays where it is then */
    real blur[3];
    blurs(state, blur);
    for (int n = 0; n < LOADED; ++n) {
        const int joint = loaded[n];
        const int states = first_state[joint + 1] - first_state[joint];
        const int points = first_point[joint + 1] - first_point[joint];
        const real *const rates = law + first_law[n];
        const real *const pushed = rates + states * states;
        const real *const shown = pushed + states * points;
        const real *const passed = shown + points * states;
        real s[3][MOST_POINTS];
        real q[3][MOST_POINTS];
        real x[2][MOST_STATES + 1];
        for (int point = 0; point < points; ++point) {
            const int force = force_on[first_point[joint] + point];
            for (int order = 0; order < 3; ++order) {
                s[order][point] = 0;
                q[order][point] = 0;
            }
            for (int j = 0; force >= 0 && j < LOADS; ++j) {
                s[integrated[force]][point] += strength[force * LOADS + j] * jump[j];
                s[integrated[force] + 1][point] += strength[force * LOADS + j] * turn[j];
            }
        }
        for (int a = 0; a < states; ++a) {
            x[0][a] = 0;
            x[1][a] = 0;
        }
        multiply(x[0], pushed, s[0], states, points);
        multiply(x[1], rates, x[0], states, states);
        multiply(x[1], pushed, s[1], states, points);
        for (int order = 0; order < 3; ++order) {
            multiply(q[order], passed, s[order], points, points);
            if (order > 0) {
                multiply(q[order], shown, x[order - 1], points, states);
            }
        }
        for (int point = 0; point < points; ++point) {
            real sum = 0, due = 0;
            for (int order = 0; order < 3; ++order) {
                sum += blur[order] * absolute(q[order][point]);
                due += whole[order] * absolute(q[order][point]);
            }
            if (sends(joint, point)) {
                lose(state, sum);
                state->due = due > state->due ? due : state->due;
            }
        }
    }
}

/* What loads make of a point now. */
static void own_velocities(const stream *state, real *q)
{
    for (int n = 0; n < LOADED; ++n) {
        const int joint = loaded[n];
        const int states = first_state[joint + 1] - first_state[joint];
        const int points = first_point[joint + 1] - first_point[joint];
        const real *const shown = law + first_law[n] + states * states + states * points;
        const real *const passed = shown + points * states;
        real s[MOST_POINTS];
        for (int point = 0; point < points; ++point) {
            const int force = force_on[first_point[joint] + point];
            s[point] = force >= 0 ? state->force[force] : (real)0;
            q[first_own[n] + point] = 0;
        }
        multiply(q + first_own[n], shown, state->own + first_state[joint], points, states);
        multiply(q + first_own[n], passed, s, points, points);
    }
}

static void read_now(const stream *state, real *out)
{
    real q[OWN_POINTS + 1] = {0};
    own_velocities(state, q);
    for (int output = 0; output < OUTPUTS; ++output) {
        out[output] = state->total[output];
        for (int k = first_heard[output]; k < first_heard[output + 1]; ++k) {
            real now = summed[k] ? integral(state, k, state->time) : value(state, k);
            if (own_point[k] >= 0) {
                now += own_ratio[k] * (summed[k] ? state->moved[own_point[k]] : q[own_point[k]]);
            }
            out[output] += gain[k] * now;
        }
    }
}

/* (high, low) as a sum of two numbers, the first of which is the sum rounded */
typedef struct {
    real high;
    real low;
} pair;

/* a + b, with what rounding takes off; volatile: every operation is rounded by itself */
static pair exact_sum(real a, real b)
{
    const volatile real sum = a + b;
    const volatile real shared = sum - a;
    const volatile real left = sum - shared;
    const volatile real first = a - left;
    const volatile real second = b - shared;
    pair result;
    result.high = sum;
    result.low = first + second;
    return result;
}

static pair plus(pair a, real high, real low)
{
    const pair sum = exact_sum(a.high, high);
    return exact_sum(sum.high, sum.low + (a.low + low));
}

/* False for what is no number, and for what is infinite. */
static int is_number(real x)
{
    return x - x == 0;
}

void name_init(stream *state)
{
    state->time = 0;
    state->time_low = 0;
    state->lost = 0;
    state->most = 0;
    state->size = 0;
    state->due = 0;
    state->alarm = 0;
    state->phase = -1;
    for (int k = 0; k < NAME_PANELS; ++k) {
        state->missed[k] = 0;
    }
    for (int k = 0; k < TRACKS; ++k) {
        state->at[k] = 0;
        for (int slot = 0; slot < slots[k]; ++slot) {
            for (int power = 0; power < SIZE; ++power) {
                state->waves[first_slot[k] + slot][power] = power == 0 ? held[k] : (real)0;
            }
        }
        state->size = slots[k] > 1 && absolute(held[k]) > state->size ? absolute(held[k]) : state->size;
    }
    for (int j = 0; j < LOADS; ++j) {
        state->load[j] = 0;
        state->slope[j] = 0;
    }
    for (int force = 0; force < FORCES; ++force) {
        state->force[force] = base[force];
    }
    for (int k = 0; k < STATES; ++k) {
        state->x[k] = begun[k];
        state->own[k] = 0;
        state->size = absolute(begun[k]) > state->size ? absolute(begun[k]) : state->size;
    }
    for (int point = 0; point < OWN_POINTS; ++point) {
        state->moved[point] = 0;
        for (int k = 0; k < SIZE; ++k) {
            state->recorded[point][k] = 0;
        }
    }
    for (int output = 0; output < OUTPUTS; ++output) {
        state->total[output] = 0;
    }
    begin(state);
}

/* To `then` on the way to the end of a step that began at `before`: loads are straight. */
static void go_on(stream *state, pair then, real done, const real *before, const real *load)
{
    const real gone = (then.high - state->time) + (then.low - state->time_low);
    /* as it is, which no prover sees of sums in two numbers */
    const real span = gone == gone && gone < panel ? gone : panel;
    real now[LOADS + 1];
    for (int j = 0; j < LOADS; ++j) {
        now[j] = done < 1 ? before[j] + done * (load[j] - before[j]) : load[j];
    }
    if (span > 0) {
        carry(state, span, now);
    }
    state->time = then.high;
    state->time_low = then.low;
}

/* What is lost has to be small against that. */
static real against(const stream *state)
{
    return state->size > 0 ? state->size : state->due;
}

/* More than the tolerance is lost, or numbers are beyond all bounds: for good, even where larger waves follow. */
static void raise_alarm(stream *state, const real *out)
{
    const real all = against(state);
    const real most = tolerance * (all / state->most);
    int fine = is_number(all) && (!(state->most > 0) || state->lost <= most * most);
    for (int k = 0; k < NAME_PANELS; ++k) {
        fine &= is_number(state->missed[k]);
    }
    for (int output = 0; output < OUTPUTS; ++output) {
        fine &= is_number(out[output]);
    }
    state->alarm |= !fine;
}

int name_step(stream *state, real dtau, const real *load, real *out)
{
    int wrong = !(dtau == 0 || (dtau >= shortest && dtau <= longest));
    for (int j = 0; j < LOADS; ++j) {
        wrong |= !is_number(load[j]);
    }
    for (int output = 0; wrong && output < OUTPUTS; ++output) {
        out[output] = not_a_number();
    }
    if (wrong) {
        return 1;
    }
    {
        const pair edge = {panel, panel_low};
        pair then = {state->time, state->time_low};
        real before[LOADS + 1];
        real jump[LOADS + 1];
        real turn[LOADS + 1];
        real past = 0;
        for (int j = 0; j < LOADS; ++j) {
            const real slope = dtau > 0 ? (load[j] - state->load[j]) / dtau : (real)0;
            before[j] = state->load[j];
            jump[j] = dtau > 0 ? (real)0 : load[j] - state->load[j];
            turn[j] = dtau > 0 ? slope - state->slope[j] : (real)0;
            state->slope[j] += turn[j];
        }
        bend(state, dtau, jump, turn);
        if (!(dtau > 0)) {
            for (int j = 0; j < LOADS; ++j) {
                state->load[j] = load[j];
            }
            press(state, load);
        }
        then = plus(then, dtau, 0);
        while (then.high > panel || (!(then.high < panel) && then.low >= panel_low)) {
            past += panel - state->time;
            go_on(state, edge, past / dtau, before, load);
            finish(state);
            state->time = 0;
            state->time_low = 0;
            begin(state);
            then = plus(then, -panel, -panel_low);
        }
        go_on(state, then, 1, before, load);
    }
    read_now(state, out);
    raise_alarm(state, out);
    return state->alarm ? 2 : 0;
}

real name_lost(const stream *state)
{
    return state->lost > 0 && is_number(state->lost) ? root(state->lost) * (state->most / against(state)) : state->lost;
}
