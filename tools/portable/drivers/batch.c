/* batch.c: models of several sets at once, bounds, and sums of squares against data. A set is in a batch what it is alone,
 * but for what both may be wrong by, and for being refused; no misfit is other than what its values say. */
#include "models.h"

enum { SETS = NAME_WIDTH + 2, POINTS = 24 };

static void bounded(const name_parameters *set, const name_model *alone, int status)
{
    static name_model model;
    name_real bound[NAME_OUTPUTS];
    memset(&model, 0xff, sizeof model);
    MUST(name_error_bound(&model, set, bound) == status);
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        MUST(status ? bound[output] != bound[output] : bound[output] >= 0);
    }
    if (status == 0) {
        MUST(name_error_estimate(&model) >= name_error_estimate(alone));
        MUST(name_error_estimate(&model) <= name_error_estimate(alone));
    }
}

/* Two models of one set. */
static void alike(const name_model *one, const name_model *other, name_real tau)
{
    name_real here[NAME_OUTPUTS], there[NAME_OUTPUTS];
    const name_real slack = apart(one, other);
    look(one, 0, tau, here);
    look(other, 0, tau, there);
    for (int output = 0; in_range(tau) && output < NAME_OUTPUTS; ++output) {
        MUST(!(size_of(here[output] - there[output]) > slack));
    }
}

/* The same sum from values. */
static void compared(const name_model *model, name_real misfit, const name_real *tau, const name_real *values, size_t count)
{
    name_real sum = 0, all = 0;
    for (size_t k = 0; k < count; ++k) {
        name_real out[NAME_OUTPUTS];
        if (name_model_eval(model, tau[k], out) == 0) {
            for (size_t output = 0; output < NAME_OUTPUTS; ++output) {
                const name_real value = values[output * count + k];
                sum += finite(value) ? (out[output] - value) * (out[output] - value) : 0;
                all += finite(value) ? value * value : 0;
            }
        }
    }
    all += (name_real)(count * NAME_OUTPUTS) * sizes(model) * sizes(model);
    MUST(!finite(all) || size_of(misfit - sum) <= 4096 * NAME_DEGREE * rounding() * all);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    told t = {bytes, count};
    static name_batch batch;
    static name_model model, member;
    const size_t sets = (size_t)choice(&t, SETS + 1);
    const size_t points = (size_t)choice(&t, POINTS);
    name_parameters *const set = (name_parameters *)malloc((sets + (sets == 0)) * sizeof *set);
    name_real *const tau = room(points);
    name_real *const values = room(NAME_OUTPUTS * points);
    name_real misfit[NAME_WIDTH];
    name_data data;
    int outside = 0;
    MUST(set != NULL);
    for (size_t k = 0; k < points; ++k) {
        tau[k] = number(&t);
        outside |= !in_range(tau[k]);
    }
    for (size_t k = 0; k < NAME_OUTPUTS * points; ++k) {
        values[k] = choice(&t, 4) ? (name_real)(k % 3) : number(&t);
    }
    for (size_t k = 0; k < sets; ++k) {
        some_parameters(&t, set + k);
    }
    memset(&batch, 0xff, sizeof batch);
    const int status = name_build_batch(&batch, set, sets);
    name_real *const numbers = room(name_data_size(tau, points));
    MUST(name_data_init(&data, numbers, tau, values, points) == outside);
    name_batch_misfit(&batch, &data, misfit);
    int largest = 0;
    for (int k = 0; k < NAME_WIDTH; ++k) {
        const int there = (size_t)k < sets;
        MUST(batch.status[k] >= !there && batch.status[k] <= 2);
        memset(&member, 0xff, sizeof member);
        MUST(name_batch_model(&batch, k, &member) == (batch.status[k] != 0));
        MUST(batch.status[k] == 0 || misfit[k] != misfit[k]);
        if (there) {
            memset(&model, 0xff, sizeof model);
            const int alone = name_build(&model, set + k);
            largest = batch.status[k] > largest ? batch.status[k] : largest;
            MUST(alone == 0 || batch.status[k] != 0);
            bounded(set + k, &model, alone);
            if (batch.status[k] == 0) {
                alike(&model, &member, points > 0 ? tau[0] : (name_real)1);
                compared(&member, misfit[k], tau, values, points);
            }
        }
    }
    MUST(status == largest);
    MUST(name_batch_model(&batch, -1, &member) == 1 && name_batch_model(&batch, NAME_WIDTH, &member) == 1);
    free(numbers);
    free(values);
    free(tau);
    free(set);
    return 0;
}
