/* runtime.c: models of any parameters, their extremes and derivatives, read anywhere. A model that is refused has no
 * values; of one that is built all are numbers, `sample` and `eval` agree but for rounding, and derivatives leave values as
 * they are but for what both may be wrong by, as they may need other degrees. */
#include "models.h"

enum { MOST = 40 };

static void sampled(const name_model *model, int status, name_real tau0, name_real dtau, size_t count)
{
    name_real *const rows = room(NAME_OUTPUTS * count);
    const name_real slack = status ? 0 : rounded(model);
    const int found = name_model_sample(model, tau0, dtau, count, rows);
    int outside = 0;
    for (size_t k = 0; k < count; ++k) {
        const volatile name_real step = (name_real)k * dtau;
        const name_real tau = tau0 + step;
        name_real out[NAME_OUTPUTS];
        look(model, status, tau, out);
        for (size_t output = 0; output < NAME_OUTPUTS; ++output) {
            const name_real value = rows[output * count + k];
            MUST(status || !in_range(tau) ? value != value : size_of(value - out[output]) <= slack);
        }
        outside |= status || !in_range(tau);
    }
    MUST(found == outside);
    free(rows);
}

static void derived(const name_parameters *set, const name_model *model, int status, name_real tau0, name_real dtau,
                    size_t count)
{
    static name_tangent tangent;
    name_real *const rows = room((NAME_LANES + 1) * NAME_OUTPUTS * count);
    name_real out[NAME_OUTPUTS];
    memset(&tangent, 0xff, sizeof tangent);
    const int found = name_build_tangent(&tangent, set);
    const int outside = name_tangent_sample(&tangent, tau0, dtau, count, rows);
    look(&tangent.value, found, tau0, out);
    for (int lane = -1; lane <= NAME_LANES + 1; ++lane) {
        const name_real estimate = name_tangent_estimate(&tangent, lane);
        MUST(found || lane < 0 || lane > NAME_LANES ? estimate != estimate : estimate >= 0);
    }
    /* of two degrees rounding may make one too low: where it hides most digits, which the estimate tells */
    MUST(status == 0 || found != 0 || (status == 2 && name_error_estimate(&tangent.value) > (name_real)1e-6));
    const name_real slack = found ? 0 : apart(&tangent.value, model);
    for (size_t k = 0; k < count; ++k) {
        const volatile name_real step = (name_real)k * dtau;
        const int fine = found == 0 && in_range(tau0 + step);
        MUST(fine || outside);
        for (size_t row = 0; row < (NAME_LANES + 1) * NAME_OUTPUTS; ++row) {
            const name_real value = rows[row * count + k];
            MUST(fine ? finite(value) : value != value);
        }
        if (fine) {
            (void)name_model_eval(model, tau0 + step, out);
            for (size_t output = 0; output < NAME_OUTPUTS; ++output) {
                MUST(!(size_of(rows[output * count + k] - out[output]) > slack));
            }
        }
    }
    free(rows);
}

/* The same model, wherever it was built; and its extremes, which are some of its values. */
static void peaked(const name_model *model, const name_model *other, int status)
{
    name_real out[NAME_OUTPUTS], peaks[4 * NAME_OUTPUTS];
    const name_real slack = status ? 0 : rounded(model);
    for (int window = 0; status == 0 && window < NAME_WINDOWS; ++window) {
        const size_t begin = model->place[window], size = NAME_STRANDS * ((size_t)model->degree[window] + 2);
        MUST(memcmp(model->series + begin, other->series + begin, size * sizeof *model->series) == 0);
    }
    MUST(name_model_peaks(other, peaks) == (status != 0));
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        const name_real *const peak = peaks + 4 * output;
        MUST(status ? peak[0] != peak[0] && peak[2] != peak[2] : peak[0] <= peak[2]);
        if (status == 0 && name_model_eval(model, peak[3], out) == 0) {
            MUST(out[output] - peak[2] <= slack);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    told t = {bytes, count};
    static name_work work;
    static name_model model, other;
    name_parameters set;
    some_parameters(&t, &set);
    const name_real tau0 = number(&t);
    const name_real dtau = number(&t);
    const size_t samples = (size_t)choice(&t, MOST);
    memset(&model, 0xff, sizeof model);
    memset(&other, 0xff, sizeof other);
    memset(&work, 0xff, sizeof work);
    const int status = name_build(&model, &set);
    MUST(name_build_with(&work, &other, &set) == status);
    peaked(&model, &other, status);
    sampled(&model, status, tau0, dtau, samples);
    derived(&set, &model, status, tau0, dtau, samples);
    return 0;
}
