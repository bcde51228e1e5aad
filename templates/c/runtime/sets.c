/* sets.c: many sets of parameters in one call, for callers to whom a call costs more than a model. */
#include "misfit.c"

void name_sets(const name_parameters *parameters, size_t sets, name_batch *batch, name_model *model,
               const name_real *tau, int even, size_t count, int *status, name_real *estimate, name_real *out);
void name_sets_peaks(const name_parameters *parameters, size_t sets, name_batch *batch, name_model *model,
                     int *status, name_real *estimate, name_real *out);
void name_sets_misfits(const name_parameters *parameters, size_t sets, name_batch *batch, const name_data *data,
                       int *status, name_real *estimate, name_real *out);

/* The model of a set: side by side with its neighbours where there are some, alone where it is refused beside them. */
static int one_of(const name_parameters *parameters, size_t sets, size_t set, name_batch *batch, name_model *model)
{
    const size_t place = set % NAME_WIDTH;
    if (!batch || NAME_WIDTH == 1 || sets - (set - place) < NAME_WIDTH / 2) {
        return name_build(model, parameters + set);
    }
    if (place == 0) {
        (void)name_build_batch(batch, parameters + set, sets - set);
    }
    return name_batch_model(batch, (int)place, model) ? name_build(model, parameters + set) : 0;
}

/* Of each set the status, the estimate, and all outputs at `count` instants: out[(set*OUTPUTS + output)*count + k]. Where
 * they are `even` these are tau[0] + k*tau[1]. */
void name_sets(const name_parameters *parameters, size_t sets, name_batch *batch, name_model *model,
               const name_real *tau, int even, size_t count, int *status, name_real *estimate, name_real *out)
{
    for (size_t set = 0; set < sets; ++set) {
        name_real *const all = out + set * NAME_OUTPUTS * count;
        status[set] = one_of(parameters, sets, set, batch, model);
        estimate[set] = name_error_estimate(model);
        if (even) {
            (void)name_model_sample(model, tau[0], tau[1], count, all);
        }
        for (size_t k = 0; !even && k < count; ++k) {
            name_real now[NAME_OUTPUTS];
            (void)name_model_eval(model, tau[k], now);
            for (size_t output = 0; output < NAME_OUTPUTS; ++output) {
                all[output * count + k] = now[output];
            }
        }
    }
}

/* Of each set the status, the estimate, and the peaks: out[set*OUTPUTS*4 ...]. */
void name_sets_peaks(const name_parameters *parameters, size_t sets, name_batch *batch, name_model *model,
                     int *status, name_real *estimate, name_real *out)
{
    for (size_t set = 0; set < sets; ++set) {
        status[set] = one_of(parameters, sets, set, batch, model);
        estimate[set] = name_error_estimate(model);
        (void)name_model_peaks(model, out + set * NAME_OUTPUTS * 4);
    }
}

/* Of each set the status, the estimate, and the sum of the squares of its misfits. What is refused beside others is
 * built again by itself. */
void name_sets_misfits(const name_parameters *parameters, size_t sets, name_batch *batch, const name_data *data,
                       int *status, name_real *estimate, name_real *out)
{
    for (size_t set = 0; set < sets; set += NAME_WIDTH) {
        name_real misfit[NAME_WIDTH];
        (void)name_build_batch(batch, parameters + set, sets - set);
        name_batch_misfit(batch, data, misfit);
        for (size_t k = 0; k < NAME_WIDTH && set + k < sets; ++k) {
            status[set + k] = batch->status[k];
            estimate[set + k] = batch->estimate[k];
            out[set + k] = misfit[k];
        }
        for (size_t k = 0; k < NAME_WIDTH && set + k < sets; ++k) {
            if (status[set + k]) {
                status[set + k] = name_build_batch(batch, parameters + set + k, 1);
                name_batch_misfit(batch, data, misfit);
                estimate[set + k] = batch->estimate[0];
                out[set + k] = misfit[0];
            }
        }
    }
}
