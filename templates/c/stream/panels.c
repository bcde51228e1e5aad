/* panels.c: how a panel of a stream begins and ends: joints, from its start on and after breakpoints, and loads. */
#include "waves.c"

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
static BY_ITSELF void add_gain(stream *state, int joint, const real *velocities, real span)
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

/* A wave of a breakpoint that is as small as rounding is left out. Whether it is not. */
static BY_ITSELF int drop_small_wave(stream *state, int breakpoint, int number)
{
    real *const out = sent_wave(state, breakpoint, number);
    const real much = root_impedance[number] * size_of(out);
    const int large = much > least * state->size;
    state->rounded += rounding * much;
    if (!large && much > 0) {
        lose(state, root_panel * much, much);
        clear(out, SIZE);
    }
    return large;
}

/* All of them. Whether some are left. */
static int drop_small_waves(stream *state, int breakpoint)
{
    int left = 0;
    for (int k = 0; k < TRACKS; ++k) {
        left |= drop_small_wave(state, breakpoint, k);
    }
    return left;
}

/* What has gone on from the breakpoints of this panel is at them again; where nothing is left of it, their place is free. */
static void continue_breakpoints(stream *state)
{
    int before = NONE;
    int after = state->first_breakpoint[state->phase];
    while (after >= 0) {
        const int next = state->next_breakpoint[after];
        step_joints(state, after, NULL);
        const int silent = drop_small_waves(state, after) ? 0 : state->silent[after] + 1;
        if (silent <= DEEPEST) {
            state->silent[after] = silent;
            before = after;
        } else {
            if (before >= 0) {
                state->next_breakpoint[before] = next;
            } else {
                state->first_breakpoint[state->phase] = next;
            }
            state->next_breakpoint[after] = state->spare;
            state->spare = after;
        }
        after = next;
    }
}

/* Forces as series on a panel, of loads that go straight from `load`; or what they change by where these change. */
static void set_forces(const stream *state, real *acting, const real *load, const real *slope, int change)
{
    const real half = panel / 2;
    for (int force = 0; force < FORCES; ++force) {
        real power[3] = {change ? (real)0 : base[force], 0, 0};
        for (int j = 0; j < LOADS; ++j) {
            power[0] += strength[force * LOADS + j] * load[j];
            power[1] += strength[force * LOADS + j] * slope[j];
        }
        if (integrated[force]) {
            power[2] = power[1] / 2;
            power[1] = power[0] - (change ? (real)0 : base[force]);
            power[0] = change ? (real)0 : state->force[force];
        }
        load_series(power, half, half, acting + force * POWERS);
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
