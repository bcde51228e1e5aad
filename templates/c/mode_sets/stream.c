/* stream.c: loads sample by sample. */
#define STREAMED
#include "build.c"

/* False for what is no number, and for what is infinite. */
static int is_number(real x)
{
    return x - x == 0;
}

void name_init(stream *state)
{
    rest(&state->motion);
    for (int j = 0; j < LOADS; ++j) {
        state->load[j] = 0;
    }
}

int name_build(stream *state, const name_parameters *parameters)
{
    name_init(state);
    return build(&state->model, parameters);
}

real name_error_estimate(const stream *state)
{
    return state->model.estimate;
}

int name_step(stream *state, real dtau, const real *load, real *out)
{
    const model *const m = &state->model;
    motion *const s = &state->motion;
    real values[FILLED];
    real now[LOADS];
    real slope[LOADS];
    int wrong = !(dtau >= shortest && dtau <= longest);
    for (int j = 0; j < LOADS; ++j) {
        wrong |= !is_number(load[j]);
        now[j] = load[j] / load_unit[j];
        s->load[j] = state->load[j] / load_unit[j];
        slope[j] = (now[j] - s->load[j]) / spacing;
    }
    if (wrong || m->status == 1) {
        for (int output = 0; output < OUTPUTS; ++output) {
            out[output] = not_a_number();
        }
        return wrong ? 1 : 2;
    }
    advance(m, &m->half, spacing / 2, slope, s, s);
    advance(m, &m->half, spacing / 2, slope, s, s);
    for (int j = 0; j < LOADS; ++j) {
        s->load[j] = now[j];
        state->load[j] = load[j];
    }
    read_motion(m, s, values);
    for (int output = 0; output < OUTPUTS; ++output) {
        wrong |= !is_number(values[output]);
        out[output] = values[output];
    }
    return wrong ? 2 : 0;
}
