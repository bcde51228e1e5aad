/* breakpoints.c: loads of a stream that jump and bend, at breakpoints and where there is no room for one. */
#include "panels.c"

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
static BY_ITSELF void interpolation_error(const real *known, real delay, real factor, real *wrong, real *square_root)
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

/* What a joint sends into each end that is at rest until loads change, for the last `span` of the panel. */
static BY_ITSELF void start_joint(stream *state, int joint, const real *acting, real span, real (*more)[SIZE])
{
    static const real nothing[SIZE] = {0};
    joint_on_panel on = no_ends;
    for (int port = 0; port < first_port[joint + 1] - first_port[joint]; ++port) {
        on.arriving[port] = nothing;
        on.sent[port] = more[port];
    }
    step_joint_of(state, joint, &on, acting, 1, span);
}

/* How a wave begins, what is rounded of it, and what it makes of waves that are due, where loads bend for so long. */
static BY_ITSELF void judge_start(stream *state, const real *wave, real factor, real late_by, real span, real *known)
{
    derivatives_at_start(wave, known);
    state->rounded += rounding * factor * size_of(wave);
    state->rounded += late_by * factor * (absolute(known[0]) / panel + absolute(known[1]) + panel * absolute(known[2]));
    state->due += factor * (absolute(known[0]) + span * (absolute(known[1]) + panel * absolute(known[2])));
}

/* Loads jump and bend now, at the start of a step: from here on joints send more. */
static BY_ITSELF void change_loads(stream *state, const real *jump, const real *bend, real dtau)
{
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
        start_joint(state, loaded[n], acting, breakpoint == EDGE ? panel : panel - state->time, more + all);
        for (int port = first_port[loaded[n]]; port < first_port[loaded[n] + 1]; ++port, ++all) {
            const real factor = root_impedance[send[port]];
            real known[4];
            judge_start(state, more[all], factor, late_by, span, known);
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
