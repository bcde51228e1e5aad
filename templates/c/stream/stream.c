/* stream.c: waves under loads that come sample by sample, panel by panel.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "tables.h"
#include "../root.h"
#include "../series.h"
#include "../joint.c"

/* A place for what has no breakpoint of its own: the start of the panel, or none that is left. */
enum { EDGE = -1, NONE = -2 };

/* Where a track has what it sent so many panels ago: its own ring, which begins where those of the tracks before end. */
static int slot_of(const stream *state, int number, int panels)
{
    const int slot = state->at[number] - panels;
    return first_slot[number] + (slot < 0 ? slot + slots[number] : slot);
}

/* The same of a breakpoint, so many windows ago. */
static int slot_after(const stream *state, int breakpoint, int number, int windows)
{
    const int slot = state->turn[number] - windows;
    return NAME_SLOTS + breakpoint * ENTRIES + first_entry[number] + (slot < 0 ? slot + entries[number] : slot);
}

/* What is sent on this panel: from its start on, or after a breakpoint; and what arrives then. */
static real *sent_wave(stream *state, int breakpoint, int number)
{
    return state->waves[breakpoint < 0 ? slot_of(state, number, 0) : slot_after(state, breakpoint, number, 0)];
}

static const real *arriving_wave(const stream *state, int breakpoint, int number)
{
    return state->waves[breakpoint < 0 ? slot_of(state, number, slots[number] - 1)
                                       : slot_after(state, breakpoint, number, entries[number] - 1)];
}

static real absolute(real x)
{
    return x < 0 ? -x : x;
}

static real size_of(const real *c)
{
    real sum = 0;
    for (int k = 0; k < SIZE; ++k) {
        sum += absolute(c[k]);
    }
    return sum;
}

/* False for what is no number, and for what is infinite. */
static int is_number(real x)
{
    return x - x == 0;
}

/* y += M a, M by rows */
static void add_rows(real *y, const real *rows, const real *a, int height, int width)
{
    for (int k = 0; k < height; ++k) {
        for (int j = 0; j < width; ++j) {
            y[k] += rows[k * width + j] * a[j];
        }
    }
}

/* Instants so near to each other are one: the time that is past is not known better. */
static real nearness(const stream *state)
{
    return nearest + rounding * state->age;
}

/* The integral of a wave from one time in its panel to another. */
static real integral(const real *c, real from, real to)
{
    return (antiderivative(c, to * scale - 1) - antiderivative(c, from * scale - 1)) / scale;
}

/* Which panel of a window was the current one so many panels ago; `windows` is how many windows ago. */
static int phase_before(const stream *state, int panels, int *windows)
{
    int phase = state->phase - panels;
    *windows = 0;
    while (phase < 0) {
        phase += NAME_PANELS;
        *windows += 1;
    }
    return phase;
}

/* A wave at one time of the panel on which it was sent; or its integral, from another time there on. */
static real read_wave(const stream *state, int number, int panels, int as_integral, real from, real to)
{
    int windows;
    int after = state->first_breakpoint[phase_before(state, panels, &windows)];
    const real *c = state->waves[slot_of(state, number, panels)];
    real sum = as_integral ? integral(c, from, to) : series(c, to * scale - 1);
    for (; after >= 0; after = state->next_breakpoint[after]) {
        const real since = to - state->place[after];
        c = state->waves[slot_after(state, after, number, windows)];
        if (as_integral && since > 0) {
            sum += integral(c, from > state->place[after] ? from - state->place[after] : (real)0, since);
        } else if (!as_integral && since >= -nearness(state)) {
            sum += series(c, since > 0 ? since * scale - 1 : (real)-1);
        }
    }
    return sum;
}

/* The integral of term k of an output from the start of the current panel to t. */
static real integral_since(const stream *state, int k, real t)
{
    const real early = rest[k] > 0 && t < rest[k] ? t : rest[k];
    real sum = read_wave(state, track[k], late[k], 1, 0, t - early);
    if (rest[k] > 0) {
        sum += read_wave(state, track[k], late[k] + 1, 1, panel - rest[k], panel - rest[k] + early);
    }
    return sum;
}

static real value_now(const stream *state, int k)
{
    const real t = state->time - rest[k];
    const int before = t < -nearness(state);
    return read_wave(state, track[k], late[k] + before, 0, 0, before ? t + panel : t);
}

/* More by which polynomials have missed the truth: of the root of an energy, and of a wave at once. */
static void lose(stream *state, real energy, real wave)
{
    state->lost_energy += energy;
    state->lost_wave += wave;
}

/* What the polynomials of a joint miss under what is given to it, of its states. */
static void lose_truncation(stream *state, int joint, const real *given, const real *velocities)
{
    const int states = first_state[joint + 1] - first_state[joint];
    const real *const factors = slip + first_slip[joint];
    real missed[MOST_STATES] = {0};
    real sum = 0;
    if (BODIES > 0 && law[joint] == BODY) {
        missed[0] = factors[0] * (given[DEGREE] - velocities[DEGREE]);
    } else if (BLOCKS > 0) {
        add_rows(missed, factors, given, states, (first_point[joint + 1] - first_point[joint]) * SIZE + states);
    }
    for (int k = 0; k < states; ++k) {
        sum += absolute(missed[k]);
    }
    lose(state, sum, rough * sum);
    state->lost_slope += steep * sum;
}

/* The state at the end of the panel gains what moves for so long, from rest: velocities, and by how much springs have
 * become longer. */
static void add_gain(stream *state, int joint, const real *velocities, real span)
{
    const int points = first_point[joint + 1] - first_point[joint];
    for (int a = first_state[joint]; a < first_state[joint + 1]; ++a) {
        const real *const stretch = lengthening + first_stretch[joint] + (a - first_state[joint]) * points;
        if (moves_with[a] >= 0) {
            state->x[a] += series(velocities + moves_with[a] * SIZE, span * scale - 1);
        } else {
            for (int point = 0; point < points; ++point) {
                state->x[a] += stretch[point] * integral(velocities + point * SIZE, 0, span);
            }
        }
    }
}

/* A joint on the panel that begins; or from rest, for the last `span` of the panel. */
static void step_joint_of(stream *state, int joint, joint_on_panel *on, const real *acting, int at_rest, real span)
{
    real given[WIDEST + 1];
    real velocities[WIDEST];
    real x[MOST_STATES] = {0};
    on->table = matrix + answer[joint];
    on->pushes = push + first_port[joint];
    on->driven = drive[joint];
    step_joint(joint, on, acting, at_rest ? x : state->x + first_state[joint], given, velocities);
    if (first_state[joint] < first_state[joint + 1]) {
        lose_truncation(state, joint, given, velocities);
        if (at_rest) {
            add_gain(state, joint, velocities, span);
        }
    }
}

/* All joints on the panel that begins; or after a breakpoint of it, where anything arrives. */
static void step_joints(stream *state, int breakpoint, const real *acting)
{
    for (int joint = 0; joint < JOINTS; ++joint) {
        const int ports = first_port[joint + 1] - first_port[joint];
        real arrives = breakpoint < 0 ? (real)1 : (real)0;
        joint_on_panel on = no_ends;
        for (int k = 0; k < ports; ++k) {
            on.arriving[k] = arriving_wave(state, breakpoint, arrive[first_port[joint] + k]);
            on.sent[k] = sent_wave(state, breakpoint, send[first_port[joint] + k]);
            arrives += breakpoint < 0 ? (real)0 : size_of(on.arriving[k]);
        }
        if (!(arrives <= 0)) {
            step_joint_of(state, joint, &on, acting, breakpoint >= 0, breakpoint < 0 ? panel : panel - state->place[breakpoint]);
        } else {
            for (int k = 0; k < ports; ++k) {
                clear(on.sent[k], SIZE);
            }
        }
    }
}

/* Waves of a breakpoint that are as small as rounding are left out. Whether there are others. */
static int drop_small_waves(stream *state, int breakpoint)
{
    int left = 0;
    for (int k = 0; k < TRACKS; ++k) {
        real *const out = sent_wave(state, breakpoint, k);
        const real much = root_impedance[k] * size_of(out);
        state->rounded += rounding * much;
        if (much > least * state->size) {
            left = 1;
        } else if (much > 0) {
            lose(state, root_panel * much, much);
            clear(out, SIZE);
        }
    }
    return left;
}

/* What has gone on from the breakpoints of this panel is at them again; where nothing is left of it, their place is free. */
static void continue_breakpoints(stream *state)
{
    int *place = state->first_breakpoint + state->phase;
    while (*place >= 0) {
        const int after = *place;
        step_joints(state, after, NULL);
        state->silent[after] = drop_small_waves(state, after) ? 0 : state->silent[after] + 1;
        if (state->silent[after] > DEEPEST) {
            *place = state->next_breakpoint[after];
            state->next_breakpoint[after] = state->spare;
            state->spare = after;
        } else {
            place = state->next_breakpoint + after;
        }
    }
}

/* Forces as series on a panel, of loads that go straight from `load`; or what they change by where these change. */
static void set_forces(const stream *state, real *acting, const real *load, const real *slope, int change)
{
    const real half = panel / 2;
    for (int force = 0; force < FORCES; ++force) {
        real constant = change ? (real)0 : base[force];
        real linear = 0;
        real square = 0;
        for (int j = 0; j < LOADS; ++j) {
            constant += strength[force * LOADS + j] * load[j];
            linear += strength[force * LOADS + j] * slope[j];
        }
        if (integrated[force]) {
            square = linear / 2;
            linear = constant - (change ? (real)0 : base[force]);
            constant = change ? (real)0 : state->force[force];
        }
        linear *= half;
        square *= half * half / 2;
        acting[force * POWERS] = constant + linear + 3 * square;
        acting[force * POWERS + 1] = linear + 4 * square;
        acting[force * POWERS + 2] = square;
    }
}

/* A panel begins: all that arrives on it is known, and what joints make of that and of loads follows. */
static void start_panel(stream *state)
{
    real acting[(FORCES + 1) * POWERS] = {0};
    state->phase += 1;
    if (state->phase >= NAME_PANELS) {
        state->phase = 0;
        state->lost_slope += growth * state->lost_energy;
        for (int k = 0; k < TRACKS; ++k) {
            state->turn[k] = state->turn[k] + 1 < entries[k] ? state->turn[k] + 1 : 0;
        }
    }
    set_forces(state, acting, state->load, state->slope, 0);
    step_joints(state, EDGE, acting);
    continue_breakpoints(state);
}

/* It is over, and what was sent is on its way. */
static void end_panel(stream *state)
{
    for (int output = 0; output < OUTPUTS; ++output) {
        for (int k = first_term[output]; k < first_term[output + 1]; ++k) {
            if (summed[k]) {
                state->total[output] += gain[k] * integral_since(state, k, panel);
            }
        }
    }
    for (int k = 0; k < TRACKS; ++k) {
        const real of_all = state->first_breakpoint[state->phase] < 0 ? sent_wave(state, EDGE, k)[0]
                                                                      : read_wave(state, k, 0, 1, 0, panel) / panel;
        const real mean = root_impedance[k] * absolute(of_all);
        state->size = slots[k] > 1 && mean > state->size ? mean : state->size;
        state->at[k] = state->at[k] + 1 < slots[k] ? state->at[k] + 1 : 0;
    }
    state->rounded += rounding * state->size;
    state->due = 0;
}

/* The breakpoint that is now, or the start of the panel, or none. */
static int breakpoint_now(const stream *state)
{
    const real near = nearness(state);
    int found = state->time <= near ? EDGE : NONE;
    for (int after = state->first_breakpoint[state->phase]; found == NONE && after >= 0;
         after = state->next_breakpoint[after]) {
        found = absolute(state->time - state->place[after]) <= near ? after : NONE;
    }
    return found;
}

/* By how much what happens now is moved, to a breakpoint or an edge that is near; and what rounding makes of instants. */
static real time_moved(const stream *state, int breakpoint)
{
    const real place = breakpoint >= 0 ? state->place[breakpoint] : breakpoint == EDGE ? (real)0 : state->time;
    return absolute(state->time - place) + rounding * panel;
}

/* One more, at this instant, if there is room. */
static int new_breakpoint(stream *state)
{
    int found = state->spare;
    if (found >= 0) {
        state->spare = state->next_breakpoint[found];
    } else if (state->breakpoints < NAME_BREAKPOINTS) {
        found = state->breakpoints;
        state->breakpoints += 1;
    } else {
        return NONE;
    }
    state->place[found] = state->time;
    state->silent[found] = 0;
    state->next_breakpoint[found] = state->first_breakpoint[state->phase];
    state->first_breakpoint[state->phase] = found;
    for (int slot = NAME_SLOTS + found * ENTRIES; slot < NAME_SLOTS + (found + 1) * ENTRIES; ++slot) {
        clear(state->waves[slot], SIZE);
    }
    return found;
}

/* The polynomial on the panel through the values, at its instants, of a wave that begins so late. */
static void interpolate(real *instead, const real *wave, real delay)
{
    real at[SIZE];
    for (int k = 0; k < SIZE; ++k) {
        at[k] = instant[k] >= delay ? series(wave, (instant[k] - delay) * scale - 1) : (real)0;
        instead[k] = 0;
    }
    add_rows(instead, transform, at, SIZE, SIZE);
}

/* The jump, kink and bend with which a wave begins, and how much it bends elsewhere at most. */
static void derivatives_at_start(const real *wave, real *known)
{
    clear(known, 4);
    for (int k = 0; k < SIZE; ++k) {
        const real square = (real)k * (real)k;
        const real turned = k % 2 ? -wave[k] : wave[k];
        known[0] += turned;
        known[1] -= turned * square * scale;
        known[2] += turned * square * (square - 1) / 3 * scale * scale;
        known[3] += absolute(wave[k]) * square * (square - 1) * absolute(square - 4) / 15 * scale * scale * scale;
    }
}

/* How wrong a polynomial is then, at most; and the root of the integral of the square. */
static void interpolation_error(const real *known, real delay, real factor, real *wrong, real *square_root)
{
    /* between an edge and the instant next to it nothing is wrong but there */
    const int at_edge = delay <= instant[0] || delay > instant[DEGREE];
    const real left = panel - delay;
    const real span = delay <= instant[0] ? delay : left;
    real edge = 1;
    for (int order = 0; order < 3; ++order) {
        const real size = factor * absolute(known[order]);
        *wrong += size * (at_edge ? edge : kink[2 * order]);
        *square_root += size * (at_edge ? edge * root(span) : kink[2 * order + 1]);
        edge *= span / (real)(order + 1);
    }
    *wrong += factor * known[3] * left * kink[4];
    *square_root += factor * known[3] * left * kink[5];
}

/* Loads jump and bend now, at the start of a step: from here on joints send more. */
static void change_loads(stream *state, const real *jump, const real *bend, real dtau)
{
    static const real nothing[SIZE] = {0};
    const real span = dtau > 0 && dtau < panel ? dtau : panel; /* a load bends for this step, and stays where it is then */
    real acting[(FORCES + 1) * POWERS] = {0};
    real more[LOADED_PORTS + 1][SIZE];
    int breakpoint = breakpoint_now(state);
    const real late_by = time_moved(state, breakpoint);
    real missed = 0;
    real energy = 0;
    int all = 0;
    set_forces(state, acting, jump, bend, 1);
    for (int n = 0; n < LOADED; ++n) {
        const int first = first_port[loaded[n]];
        const int ports = first_port[loaded[n] + 1] - first;
        joint_on_panel on = no_ends;
        for (int port = 0; port < ports; ++port) {
            on.arriving[port] = nothing;
            on.sent[port] = more[all + port];
        }
        step_joint_of(state, loaded[n], &on, acting, 1, breakpoint == EDGE ? panel : panel - state->time);
        for (int port = 0; port < ports; ++port, ++all) {
            const real factor = root_impedance[send[first + port]];
            real known[4];
            derivatives_at_start(more[all], known);
            state->rounded += rounding * factor * size_of(more[all]);
            state->rounded += late_by * factor * (absolute(known[0]) / panel + absolute(known[1]) + panel * absolute(known[2]));
            state->due += factor * (absolute(known[0]) + span * (absolute(known[1]) + panel * absolute(known[2])));
            if (breakpoint == NONE) {
                interpolation_error(known, state->time, factor, &missed, &energy);
            }
        }
    }
    if (breakpoint == NONE && !(missed <= share * dtau * state->size)) {
        breakpoint = new_breakpoint(state);
    }
    all = 0;
    for (int n = 0; n < LOADED; ++n) {
        for (int port = first_port[loaded[n]]; port < first_port[loaded[n] + 1]; ++port, ++all) {
            real instead[SIZE];
            if (breakpoint == NONE) {
                interpolate(instead, more[all], state->time);
            }
            add(sent_wave(state, breakpoint, send[port]), 1, breakpoint == NONE ? instead : more[all], SIZE);
        }
    }
    if (breakpoint == NONE) {
        lose(state, energy, missed);
    }
}

/* What a load is now where an output shows it. */
static real force_now(const stream *state, int force)
{
    real sum = base[force];
    for (int j = 0; j < LOADS; ++j) {
        sum += strength[force * LOADS + j] * state->load[j];
    }
    return integrated[force] ? state->force[force] : sum;
}

static void read_outputs(stream *state, real *out)
{
    for (int output = 0; output < OUTPUTS; ++output) {
        out[output] = state->total[output];
        for (int k = first_term[output]; k < first_term[output + 1]; ++k) {
            if (summed[k]) {
                out[output] += gain[k] * integral_since(state, k, state->time);
            } else if (shown_force[k] >= 0) {
                out[output] += gain[k] * force_now(state, shown_force[k]);
            } else {
                out[output] += gain[k] * value_now(state, k);
            }
        }
        state->largest[output] = absolute(out[output]) > state->largest[output] ? absolute(out[output]) : state->largest[output];
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

void name_init(stream *state)
{
    state->time = 0;
    state->time_low = 0;
    state->age = 0;
    state->lost_energy = 0;
    state->lost_wave = 0;
    state->lost_slope = 0;
    state->rounded = 0;
    state->misread = 0;
    state->size = 0;
    state->due = 0;
    state->alarm = 0;
    state->phase = NAME_PANELS - 1;
    state->breakpoints = 0;
    state->spare = NONE;
    for (int k = 0; k < NAME_PANELS; ++k) {
        state->first_breakpoint[k] = NONE;
    }
    for (int k = 0; k < TRACKS; ++k) {
        state->at[k] = 0;
        state->turn[k] = 0;
        for (int slot = 0; slot < slots[k]; ++slot) {
            clear(state->waves[first_slot[k] + slot], SIZE);
            state->waves[first_slot[k] + slot][0] = held[k];
        }
        if (slots[k] > 1 && root_impedance[k] * absolute(held[k]) > state->size) {
            state->size = root_impedance[k] * absolute(held[k]);
        }
    }
    clear(state->load, LOADS);
    clear(state->slope, LOADS);
    for (int force = 0; force < FORCES; ++force) {
        state->force[force] = base[force];
    }
    for (int k = 0; k < STATES; ++k) {
        state->x[k] = initial_state[k];
    }
    clear(state->total, OUTPUTS);
    clear(state->largest, OUTPUTS);
    start_panel(state);
}

/* On by `span`, in which loads go straight to what they are when so much of a step is done that began at `before`. */
static void advance_loads(stream *state, real span, real done, const real *before, const real *load)
{
    for (int j = 0; j < LOADS; ++j) {
        const real now = done < 1 ? before[j] + done * (load[j] - before[j]) : load[j];
        for (int force = 0; force < FORCES; ++force) {
            if (integrated[force]) {
                state->force[force] += strength[force * LOADS + j] * (state->load[j] + now) / 2 * span;
            }
        }
        state->load[j] = now;
    }
}

/* No series on a panel is steeper. */
static real steepness(const real *c)
{
    real sum = 0;
    for (int k = 0; k < SIZE; ++k) {
        sum += absolute(c[k]) * (real)k * (real)k * scale;
    }
    return sum;
}

/* No wave that outputs read on this panel is. */
static real steepest_wave(const stream *state)
{
    real most = 0;
    for (int k = 0; k < first_term[OUTPUTS]; ++k) {
        int windows;
        int after = state->first_breakpoint[phase_before(state, late[k], &windows)];
        real sum = shown_force[k] >= 0 ? (real)0 : steepness(state->waves[slot_of(state, track[k], late[k])]);
        for (; after >= 0 && shown_force[k] < 0; after = state->next_breakpoint[after]) {
            sum += steepness(state->waves[slot_after(state, after, track[k], windows)]);
        }
        sum *= root_impedance[track[k]];
        most = sum > most ? sum : most;
    }
    return most;
}

/* A step in which loads go straight. */
static void advance(stream *state, real dtau, const real *load)
{
    pair then = {state->time, state->time_low};
    real before[LOADS + 1];
    real past = 0;
    for (int j = 0; j < LOADS; ++j) {
        before[j] = state->load[j];
    }
    then = plus(then, dtau, 0);
    state->age += dtau;
    while ((then.high - panel) + (then.low - panel_low) >= -nearness(state)) {
        /* so long before its end: outputs are read as if what happens there had happened */
        const real early = panel - then.high;
        const int is_moved = early > rounding * panel;
        real steepest = is_moved ? steepest_wave(state) : (real)0;
        past += panel - state->time;
        advance_loads(state, panel - state->time, past / dtau, before, load);
        end_panel(state);
        state->time = 0;
        state->time_low = 0;
        start_panel(state);
        then = plus(then, -panel, -panel_low);
        steepest += is_moved ? steepest_wave(state) : (real)0;
        state->misread = early * steepest > state->misread ? early * steepest : state->misread;
    }
    advance_loads(state, then.high - state->time, 1, before, load);
    state->time = then.high;
    state->time_low = then.low;
}

/* A step, loads and time of which are numbers. */
static void step_loads(stream *state, real dtau, const real *load)
{
    real jump[LOADS + 1];
    real bend[LOADS + 1];
    real middle[LOADS + 1];
    int jumps = 0;
    int bends = 0;
    const int brief = dtau < shortest_ramp;
    for (int j = 0; j < LOADS; ++j) {
        const real straight = state->load[j] + state->slope[j] * dtau;
        const real slope = brief ? state->slope[j] : (load[j] - state->load[j]) / dtau;
        middle[j] = state->load[j] + state->slope[j] * (dtau / 2);
        jump[j] = brief ? load[j] - straight : (real)0;
        bend[j] = slope - state->slope[j];
        state->slope[j] = slope;
        jumps |= jump[j] < 0 || jump[j] > 0;
        bends |= bend[j] < 0 || bend[j] > 0;
    }
    if (brief && dtau > 0) {
        advance(state, dtau / 2, middle);
    }
    if (jumps || bends) {
        change_loads(state, jump, bend, dtau);
    }
    for (int j = 0; brief && j < LOADS; ++j) {
        state->load[j] += jump[j];
    }
    if (dtau > 0) {
        advance(state, brief ? dtau / 2 : dtau, load);
    } else {
        for (int j = 0; j < LOADS; ++j) {
            state->load[j] = load[j];
        }
    }
}

/* The largest wave so far, or, before there is one, what the loads of this panel make within one. */
static real reference_size(const stream *state)
{
    return state->size > state->due ? state->size : state->due;
}

/* More than the tolerance is lost, or numbers are beyond all bounds: for good, even where larger waves follow. */
static void raise_alarm(stream *state, const real *out)
{
    const real all = reference_size(state);
    const real energy = (state->lost_energy + root_panel * (real)1.5 * state->lost_wave) / all;
    const real slope = (state->lost_slope + growth * state->lost_energy) / all;
    const real left = tolerance - state->lost_wave / all;
    const int lossless = !(state->lost_energy > 0) && is_number(state->lost_energy);
    int fine = lossless || (left >= 0 && energy * (energy / step_length + 2 * slope) <= left * left);
    fine &= is_number(all) && is_number(state->lost_energy) && is_number(state->lost_wave) && is_number(state->rounded);
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
    step_loads(state, dtau, load);
    read_outputs(state, out);
    raise_alarm(state, out);
    return state->alarm ? 2 : 0;
}

real name_lost(const stream *state)
{
    const real energy = state->lost_energy + root_panel * (real)1.5 * state->lost_wave;
    const real slope = state->lost_slope + growth * state->lost_energy;
    const real wave =
        state->lost_wave + root(energy) * root(energy / step_length + 2 * slope) + state->rounded + state->misread;
    const real gathering = (state->lost_energy * root(step_length) + state->rounded) * (state->age / step_length + 1);
    real most = energy + wave;
    most = is_number(most) ? (real)0 : most;
    for (int output = 0; output < OUTPUTS; ++output) {
        real sum = 0;
        for (int k = first_term[output]; k < first_term[output + 1]; ++k) {
            const real size = root_impedance[track[k]];
            const real of_state = state_gain[track[k]] * state->lost_energy * (summed[k] ? state->age : (real)1);
            sum += absolute(gain[k]) * (of_state + (size > 0 ? (summed[k] ? gathering : wave) / size : (real)0));
        }
        if (state->largest[output] > 0 && !(sum / state->largest[output] <= most)) {
            most = sum / state->largest[output];
        }
    }
    return most;
}
