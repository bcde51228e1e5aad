/* waves.c: where a stream has its waves, and how they are read. */
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

/* How large the polynomials are that term k of an output is read from: where they cancel, it is their rounding. */
static real size_of_term(const stream *state, int k)
{
    const int before = state->time - rest[k] < -nearness(state);
    int windows;
    int after = state->first_breakpoint[phase_before(state, late[k] + before, &windows)];
    real sum = size_of(state->waves[slot_of(state, track[k], late[k] + before)]);
    for (; after >= 0; after = state->next_breakpoint[after]) {
        sum += size_of(state->waves[slot_after(state, after, track[k], windows)]);
    }
    return absolute(gain[k]) * (summed[k] ? panel : (real)1) * sum;
}

static real value_now(const stream *state, int k)
{
    const real t = state->time - rest[k];
    const int before = t < -nearness(state);
    return read_wave(state, track[k], late[k] + before, 0, 0, before ? t + panel : t);
}
