/* read.c: values of a model that has been built, one by one and in blocks.
 * Plain C that is put below the march in NAME.c; what stands below the first empty line. */
#ifndef NAME_JOINTED
#include "builds.c"
#endif

name_real name_error_estimate(const name_model *model)
{
    return model->estimate;
}

static int inside(const model_of *m, real tau)
{
    return m->built && tau == tau && tau >= 0 && tau <= NAME_TAU_MAX;
}

/* The section at tau, of those of all windows. */
static int section_at(real tau)
{
    int cycle = (int)(tau / span);
    if (cycle > 0 && (real)cycle * span > tau) {
        --cycle;
    }
    const real t = tau - (real)cycle * span;
    const int last = CYCLE * SECTIONS - 1;
    int at = CYCLE > 1 && t > 0 ? (int)(t / window_length) * SECTIONS : 0;
    at = at < last ? at : last;
    while (at > 0 && t < from[at]) {
        --at;
    }
    while (at < last && t >= from[at + 1]) {
        ++at;
    }
    /* the last cycle need not be whole */
    const int found = cycle * CYCLE * SECTIONS + at, end = NAME_WINDOWS * SECTIONS;
    return found < end ? found : end - 1;
}

name_real name_tangent_estimate(const name_tangent *tangent, int lane)
{
    const model_of *const m = &tangent->value;
    if (lane < 0 || lane > NAME_LANES || !m->built) {
        return not_a_number();
    }
    return lane == 0 ? m->estimate : estimated_slope(tangent, lane - 1);
}

int name_model_eval(const name_model *model, name_real tau, name_real *out)
{
    if (!(model->built && tau == tau && tau >= 0 && tau <= NAME_TAU_MAX)) {
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            out[output] = not_a_number();
        }
        return 1;
    }
    const int at = section_at(tau);
    const int window = at / SECTIONS;
    const int section = at % SECTIONS;
    const real t = tau - cycle_begin(window);
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        out[output] = value(model, model->series, window, section, output, t);
    }
    return 0;
}

/* tau_k, both operations rounded. `one` is 1, which no compiler knows: so the product is rounded by itself, contracted
 * into the next operation or not. */
static real instant(real tau0, real dtau, real one, real k)
{
    const real step = k * dtau;
    return step * one + tau0;
}

/* The samples that are asked for, of a model's series or of its derivatives: `out` has `count` for each output. */
typedef struct {
    real tau0, dtau, one, per_tau;
    size_t count;
    real *out;
    const real *series;
} samples;

static const real offset[BLOCK] = {
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
};

/* A block of values of a series, added to what is there where `more`. */
static void block(const real *c, int degree, const real *u, int more, real *out)
{
    const slice *const at = (const slice *)u;
    slice *const to = (slice *)out;
    slice twice[SLICES], next[SLICES], after[SLICES];
    UNROLLED
    for (int j = 0; j < SLICES; ++j) {
        twice[j] = at[j] + at[j];
        after[j] = at[j] - at[j];
        next[j] = after[j] + c[degree];
    }
    for (int k = degree - 1; k > 0; --k) {
        UNROLLED
        for (int j = 0; j < SLICES; ++j) {
            const slice now = twice[j] * next[j] + (c[k] - after[j]);
            after[j] = next[j];
            next[j] = now;
        }
    }
    UNROLLED
    for (int j = 0; j < SLICES; ++j) {
        const slice sum = at[j] * next[j] + (c[0] - after[j]);
        if (more) {
            to[j] += sum;
        } else {
            to[j] = sum;
        }
    }
}

/* A block of an output at t after the start of a window's cycle. */
static void output_block(const model_of *m, const real *series, int window, int at, const real *t, real *out)
{
    const int degree = m->degree[window];
    int more = 0;
    real u[BLOCK];
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        const int s = strand_at[k];
        const int now = window % CYCLE * NAME_STRANDS + s;
        const real begin = strand_start[now], excess = strand_excess[now], scale = strand_scale[s];
        UNROLLED
        for (int j = 0; j < BLOCK; ++j) {
            u[j] = ((t[j] - begin) + excess) * scale - 1;
        }
        block(series + m->place[window] + (size_t)s * (size_t)(degree + 2), degree + 1, u, more, out);
        more = 1;
    }
    for (int j = 0; !more && j < BLOCK; ++j) {
        out[j] = 0;
    }
}

/* Samples k ... end - 1, all of them on one section of a window. Whole blocks are written: what is beyond the end is
 * written anew by the runs that follow. */
static void run(const model_of *m, int window, int section, const samples *s, size_t k, size_t end)
{
    const real begin = cycle_begin(window);
    real t[BLOCK], rest[BLOCK];
    for (; k < end; k += BLOCK) {
        const real first = (real)k, tau0 = s->tau0, dtau = s->dtau, one = s->one;
        UNROLLED
        for (int j = 0; j < BLOCK; ++j) {
            t[j] = instant(tau0, dtau, one, first + offset[j]) - begin;
        }
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            const int at = section * NAME_OUTPUTS + output;
            real *const row = s->out + (size_t)output * s->count;
            output_block(m, s->series, window, at, t, s->count - k < BLOCK ? rest : row + k);
            for (size_t j = 0, to = k; s->count - k < BLOCK && to < s->count; ++j, ++to) {
                row[to] = rest[j];
            }
        }
    }
}

static int on_section(const model_of *m, int window, int section, const samples *s, size_t k)
{
    const real tau = instant(s->tau0, s->dtau, s->one, (real)k);
    const real t = tau - cycle_begin(window);
    const int at = in_cycle(window, section);
    return inside(m, tau) && t >= from[at] && t < from[at + 1];
}

/* The first sample after k that is not where sample k is, or count. */
static size_t run_end(const model_of *m, int window, int section, const samples *s, size_t k)
{
    const int at = in_cycle(window, section);
    const real edge = cycle_begin(window) + (s->dtau < 0 ? from[at] : from[at + 1]);
    const real reach = (edge - s->tau0) * s->per_tau; /* about where the run ends */
    size_t end = reach == reach && reach < (real)s->count ? (reach > (real)k ? (size_t)reach : k) + 1 : s->count;
    end = end > s->count ? s->count : end;
    while (end > k + 1 && !on_section(m, window, section, s, end - 1)) {
        --end;
    }
    while (end < s->count && on_section(m, window, section, s, end)) {
        ++end;
    }
    return end;
}

static int sampled(const model_of *m, const real *series, real tau0, real dtau, size_t count, real *out)
{
    const volatile real unity = 1;
    const samples s = {tau0, dtau, unity, dtau < 0 || dtau > 0 ? 1 / dtau : 0, count, out, series};
    int outside = 0;
    size_t k = 0;
    while (k < count) {
        const real tau = instant(tau0, dtau, s.one, (real)k);
        if (m->built && tau == tau && tau >= 0 && tau <= NAME_TAU_MAX) {
            const int at = section_at(tau);
            const int window = at / SECTIONS;
            const int section = at % SECTIONS;
            const size_t end = run_end(m, window, section, &s, k);
            run(m, window, section, &s, k, end);
            k = end;
        } else {
            for (size_t output = 0; output < NAME_OUTPUTS; ++output) {
                out[output * count + k] = not_a_number();
            }
            outside = 1;
            ++k;
        }
    }
    return outside;
}

int name_model_sample(const name_model *model, name_real tau0, name_real dtau, size_t count, name_real *out)
{
    return sampled(model, model->series, tau0, dtau, count, out);
}

int name_tangent_sample(
    const name_tangent *tangent, name_real tau0, name_real dtau, size_t count, name_real *out)
{
    const model_of *const m = &tangent->value;
    int outside = sampled(m, m->series, tau0, dtau, count, out);
    for (size_t lane = 0; lane < NAME_LANES; ++lane) {
        outside |= sampled(m, tangent->series[lane], tau0, dtau, count, out + (lane + 1) * NAME_OUTPUTS * count);
    }
    return outside;
}
