/* modes.c: oscillators, step by step. */
#include "tables.h"

/* A mode is an oscillator, y'' + 2 damping frequency y' + frequency^2 y = push * load. Over one step with a load that is
 * linear from `before` to `now` it goes on exactly,
 *
 *     y = p11 y + p12 v + one0 before + one1 now,
 *     v = p21 y + p22 v + speed0 before + speed1 now,
 *
 * and an output is a sum of the modes' y, of their v, and of the loads and their integrals. */

typedef name_state stream;

/* Inner loops are unrolled, so that their sums stay in registers; not where size counts more than speed. */
#if defined(__OPTIMIZE_SIZE__)
#define UNROLLED
#elif defined(__clang__)
#define UNROLLED _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#define UNROLLED _Pragma("GCC unroll 8")
#else
#define UNROLLED
#endif

void name_init(stream *state)
{
    for (int n = 0; n < MODES; ++n) {
        state->y[n] = 0;
        state->v[n] = 0;
    }
    for (int j = 0; j < LOADS; ++j) {
        state->load[j] = 0;
        state->once[j] = 0;
        state->twice[j] = 0;
    }
}

/* All modes go on by a step without loads. */
static void turn(stream *state)
{
    for (int n = 0; n < MODES; ++n) {
        const real y = state->y[n];
        const real v = state->v[n];
        state->y[n] = p11[n] * y + p12[n] * v;
        state->v[n] = p21[n] * y + p22[n] * v;
    }
}

/* What load j has done to them, which was `before` where the step began and is `now` at its end. */
static void push(stream *state, int j, real before, real now)
{
    const real *const y0 = one0 + j * MODES;
    const real *const y1 = one1 + j * MODES;
    const real *const v0 = speed0 + j * MODES;
    const real *const v1 = speed1 + j * MODES;
    for (int n = 0; n < MODES; ++n) {
        state->y[n] += y0[n] * before + y1[n] * now;
        state->v[n] += v0[n] * before + v1[n] * now;
    }
    state->twice[j] += spacing * state->once[j] + spacing * spacing * (2 * before + now) / 6;
    state->once[j] += spacing * (before + now) / 2;
    state->load[j] = now;
}

/* out[row[k]] += the sum over the modes of weight times x, some outputs at a time. */
static void add(const real *weight, const int *row, int rows, const real *x, real *out)
{
    for (int first = 0; first < rows; first += LANES) {
        real sum[LANES] = {0};
        for (int n = 0; n < MODES; ++n) {
            UNROLLED
            for (int lane = 0; lane < LANES; ++lane) {
                sum[lane] += weight[lane] * x[n];
            }
            weight += LANES;
        }
        for (int lane = 0; lane < LANES && first + lane < rows; ++lane) {
            out[row[first + lane]] += sum[lane];
        }
    }
}

/* False for what is no number, and for what is infinite. */
static int is_number(real x)
{
    return x - x == 0;
}

int name_step(stream *state, real dtau, const real *load, real *out)
{
    int wrong = !(dtau >= shortest && dtau <= longest);
    for (int j = 0; j < LOADS; ++j) {
        wrong |= !is_number(load[j]);
    }
    for (int output = 0; output < OUTPUTS; ++output) {
        out[output] = wrong ? not_a_number() : (real)0;
    }
    if (wrong) {
        return 1;
    }
    turn(state);
    for (int j = 0; j < LOADS; ++j) {
        push(state, j, state->load[j], load[j]);
    }
    for (int output = 0; output < OUTPUTS; ++output) {
        for (int j = 0; j < LOADS; ++j) {
            const real *const factor = load_weight + 3 * (output * LOADS + j);
            out[output] += factor[0] * state->load[j] + factor[1] * state->once[j] + factor[2] * state->twice[j];
        }
    }
    add(moved_weight, moved_row, MOVED, state->y, out);
    add(moving_weight, moving_row, MOVING, state->v, out);
    for (int output = 0; output < OUTPUTS; ++output) {
        wrong |= !is_number(out[output]);
    }
    return wrong ? 2 : 0;
}
