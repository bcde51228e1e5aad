/* read.c: histories of a model under the scene's loads. */
#include "build.c"

int name_build(model *m, const name_parameters *parameters)
{
    return build(m, parameters);
}

real name_error_estimate(const model *m)
{
    return m->estimate;
}

/* Where the histories of a model have got to: after `half` steps of SPACING/2, and the turns of the time since. */
typedef struct {
    motion s;
    turns t;
    real slope[LOADS];
    real since;
    int half;
} reader;

static void begin_reading(const model *m, reader *r)
{
    rest(&r->s);
    slopes_after(m, 0, r->slope);
    r->since = -1;
    r->half = 0;
}

/* All outputs at a tau not before the last one. */
static void read_at(const model *m, reader *r, real tau, real *values)
{
    motion then;
    while ((r->half + 1) * (spacing / 2) <= tau) {
        advance(m, &m->half, spacing / 2, r->slope, &r->s, &r->s);
        r->half += 1;
        slopes_after(m, r->half / 2, r->slope);
    }
    const real since = tau - r->half * (spacing / 2);
    if (since != r->since) {
        turns_of(m->frequency, m->damping, since, &r->t);
        r->since = since;
    }
    advance(m, &r->t, since, r->slope, &r->s, &then);
    read_motion(m, &then, values);
}

int name_model_sample(const model *m, real tau0, real dtau, size_t count, real *out)
{
    reader r;
    int wrong = 0;
    begin_reading(m, &r);
    for (size_t place = 0; place < count; ++place) {
        const size_t k = dtau < 0 ? count - 1 - place : place;
        const volatile real product = (real)k * dtau;
        const real tau = tau0 + product;
        const int inside = m->status != 1 && tau >= 0 && tau <= tau_max;
        real values[FILLED];
        wrong |= !inside;
        if (inside) {
            read_at(m, &r, tau, values);
        }
        for (size_t output = 0; output < OUTPUTS; ++output) {
            out[output * count + k] = inside ? values[output] : not_a_number();
        }
    }
    return wrong;
}

int name_model_eval(const model *m, real tau, real *out)
{
    return name_model_sample(m, tau, 0, 1, out);
}
