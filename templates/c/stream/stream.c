/* stream.c: waves under loads that come sample by sample, step by step. */
#include "breakpoints.c"

/* What a load is now where an output shows it. */
static real force_now(const stream *state, int force)
{
    real sum = base[force];
    for (int j = 0; j < LOADS; ++j) {
        sum += strength[force * LOADS + j] * state->load[j];
    }
    return integrated[force] ? state->force[force] : sum;
}

/* Whether an output that rested so far does so still, but for the rounding of what it is read from. */
static int is_rounding(const stream *state, int output, real size)
{
    real sum = 0;
    for (int k = first_term[output]; k < first_term[output + 1]; ++k) {
        sum += shown_force[k] >= 0 ? absolute(gain[k] * force_now(state, shown_force[k])) : size_of_term(state, k);
    }
    return size <= 4 * rounding * sum;
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
        const real size = absolute(out[output]);
        if (size > state->largest[output] && (state->largest[output] > 0 || !is_rounding(state, output, size))) {
            state->largest[output] = size;
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

/* Loads are where they jump to. */
static BY_ITSELF void jump_loads(stream *state, const real *jump)
{
    for (int j = 0; j < LOADS; ++j) {
        state->load[j] += jump[j];
    }
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
    if (brief) {
        jump_loads(state, jump);
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
