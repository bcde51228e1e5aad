/* read.c: values of a model that has been built, one by one and in blocks. */
#include "model.c"

name_real name_error_estimate(const name_model *model)
{
    return model->estimate;
}

static int inside(const name_model *m, real tau)
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

/* So many series are read together, and so many vectors of one that is read alone. */
#ifndef __OPTIMIZE_SIZE__
enum { TOGETHER = NAME_OUTPUTS < 4 ? NAME_OUTPUTS : 4, ABREAST = 4 };
#else
enum { TOGETHER = 1, ABREAST = 1 };
#endif

/* `width` vectors of the next T_k(u), which take the place of those `before`, and what they count in values of series. */
WITHIN void next_terms(int count, int width, const real *c, size_t size, const slice *twice, const slice *now, slice *before,
                       slice *sum)
{
    UNROLLED
    for (int j = 0; j < width; ++j) {
        before[j] = twice[j] * now[j] - before[j];
        UNROLLED
        for (int i = 0; i < count; ++i) {
            sum[i * width + j] += c[(size_t)i * size] * before[j];
        }
    }
}

/* `width` vectors of values of series of `size` numbers, one behind the other, all at the same instants u: sums of
 * c_k T_k(u), which share the T_k. */
WITHIN void together(int count, int width, const real *series, size_t size, const slice *u, slice *sum)
{
    slice twice[ABREAST], now[ABREAST], before[ABREAST];
    const real *c = series + 2;
    UNROLLED
    for (int j = 0; j < width; ++j) {
        twice[j] = u[j] + u[j];
        now[j] = u[j];
        before[j] = (u[j] - u[j]) + 1;
        UNROLLED
        for (int i = 0; i < count; ++i) {
            sum[i * width + j] = u[j] * series[(size_t)i * size + 1] + series[(size_t)i * size];
        }
    }
    for (; c + 1 < series + size; c += 2) {
        next_terms(count, width, c, size, twice, now, before, sum);
        next_terms(count, width, c + 1, size, twice, before, now, sum);
    }
    if (c < series + size) {
        next_terms(count, width, c, size, twice, now, before, sum);
    }
}

/* Strands that are read together on a window: the first and how many; `more` where values are added to what is there. */
typedef struct {
    const name_model *m;
    int window, strand, more;
} strands_read;

/* `width` vectors of samples of so many strands from k on. One alone may be the last: what lies behind its samples is left
 * as it is. */
WITHIN void read_vectors(int count, int width, const strands_read *r, const samples *s, size_t k)
{
    int window = r->window, strand = r->strand;
    LOADED_HERE(window);
    LOADED_HERE(strand);
    const size_t size = (size_t)r->m->degree[window] + 2;
    const int now = window % CYCLE * NAME_STRANDS + strand;
    const real begin = cycle_begin(window), start = strand_start[now], excess = strand_excess[now];
    const real scale = strand_scale[strand], first = (real)k;
    slice u[ABREAST], sum[TOGETHER * ABREAST];
    UNROLLED
    for (int j = 0; j < width; ++j) {
        const slice step = (*slice_at(offset, 0) + (first + (real)(j * (int)LANES))) * s->dtau;
        const slice t = (step * s->one + s->tau0) - begin;
        u[j] = ((t - start) + excess) * scale - 1;
    }
    together(count, width, s->series + r->m->place[r->window] + (size_t)r->strand * size, size, u, sum);
    UNROLLED
    for (int i = 0; i < count; ++i) {
        real *const row = s->out + (size_t)strand_output[r->strand + i] * s->count;
        UNROLLED
        for (int j = 0; j < width; ++j) {
            const size_t to = k + (size_t)j * LANES;
            if (width > 1 || to + LANES <= s->count) {
                slice now_there = sum[i * width + j];
                if (r->more) {
                    now_there += *slice_at(row, to);
                }
                *(slice *)(row + to) = now_there;
                continue;
            }
            UNROLLED
            for (size_t lane = 0; lane < LANES; ++lane) {
                if (to + lane < s->count) {
                    row[to + lane] = (r->more ? row[to + lane] : (real)0) + AT(sum[i * width + j], lane);
                }
            }
        }
    }
}

/* Samples k ... end - 1 of so many strands. */
WITHIN void read_strands(int count, const strands_read *r, const samples *s, size_t k, size_t end)
{
    for (; count == 1 && ABREAST == 4 && end > k + 2 * LANES && s->count - k >= 4 * LANES; k += 4 * LANES) {
        read_vectors(count, ABREAST, r, s, k);
    }
    for (; ABREAST > 1 && end > k + LANES && s->count - k >= 2 * LANES; k += 2 * LANES) {
        read_vectors(count, 2, r, s, k);
    }
    for (; end > k; k += LANES) {
        read_vectors(count, 1, r, s, k);
    }
}

/* Samples k ... end - 1, all of them on one section of a window. Whole vectors are written: what is beyond the end is
 * written anew by the runs that follow. */
static BY_ITSELF void run(const name_model *m, int window, int section, const samples *s, size_t k, size_t end)
{
    strands_read r = {m, window, 0, 0};
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        const int at = section * NAME_OUTPUTS + output;
        for (size_t j = k; first_strand[at] == first_strand[at + 1] && j < end; ++j) {
            s->out[(size_t)output * s->count + j] = 0;
        }
    }
    for (int reading = first_reading[section]; reading < first_reading[section + 1]; ++reading) {
        const int last = reading_strand[reading] + reading_strands[reading];
        r.more = reading_more[reading];
        for (r.strand = reading_strand[reading]; r.strand < last; r.strand += TOGETHER) {
            switch (last - r.strand) {
            case 1:
                read_strands(1, &r, s, k, end);
                break;
            case 2:
                read_strands(TOGETHER < 2 ? TOGETHER : 2, &r, s, k, end);
                break;
            case 3:
                read_strands(TOGETHER < 3 ? TOGETHER : 3, &r, s, k, end);
                break;
            default:
                read_strands(TOGETHER, &r, s, k, end);
                break;
            }
        }
    }
}

/* Whether sample k is where one before it is. */
static int still_there(int window, int at, const samples *s, size_t k)
{
    const real tau = instant(s->tau0, s->dtau, s->one, (real)k), t = tau - cycle_begin(window);
    return s->dtau < 0 ? tau >= 0 && t >= from[at] : tau <= NAME_TAU_MAX && t < from[at + 1];
}

/* The first sample after k that is not where sample k is, or count. */
static size_t run_end(int window, int section, const samples *s, size_t k)
{
    const int at = in_cycle(window, section);
    const real edge = cycle_begin(window) + (s->dtau < 0 ? from[at] : from[at + 1]);
    const real reach = (edge - s->tau0) * s->per_tau; /* about where the run ends */
    size_t end = reach == reach && reach < (real)s->count ? (reach > (real)k ? (size_t)reach : k) + 1 : s->count;
    end = end > s->count ? s->count : end;
    while (end > k + 1 && !still_there(window, at, s, end - 1)) {
        --end;
    }
    while (end < s->count && still_there(window, at, s, end)) {
        ++end;
    }
    return end;
}

static int sample_series(const name_model *m, const real *series, real tau0, real dtau, size_t count, real *out)
{
    const volatile real unity = 1;
    const samples s = {tau0, dtau, unity, dtau < 0 || dtau > 0 ? 1 / dtau : 0, count, out, series};
    int outside = 0;
    size_t k = 0;
    while (k < count) {
        const real tau = instant(tau0, dtau, s.one, (real)k);
        if (inside(m, tau)) {
            const int at = section_at(tau), window = at / SECTIONS, section = at % SECTIONS;
            const size_t end = run_end(window, section, &s, k);
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
    return sample_series(model, model->series, tau0, dtau, count, out);
}

int name_model_eval(const name_model *model, name_real tau, name_real *out)
{
    return sample_series(model, model->series, tau, 0, 1, out);
}
