/* runtime_sets.c: many sets of parameters one after the other, for callers to whom a call costs more than a model.
 * Plain C that is put below NAME.c; what stands below the first empty line. */
#include "runtime_tables.h"

size_t name_model_size(void);
void name_sets(const name_parameters *parameters, size_t sets, name_model *model, const name_real *tau, int even,
               size_t count, int *status, name_real *estimate, name_real *out);

size_t name_model_size(void)
{
    return sizeof(name_model);
}

/* Of each set the status, the estimate, and all outputs at `count` instants: out[(set*OUTPUTS + output)*count + k]. Where
 * they are `even` these are tau[0] + k*tau[1]. */
void name_sets(const name_parameters *parameters, size_t sets, name_model *model, const name_real *tau, int even,
               size_t count, int *status, name_real *estimate, name_real *out)
{
    for (size_t set = 0; set < sets; ++set) {
        name_real *const all = out + set * NAME_OUTPUTS * count;
        status[set] = name_build(model, parameters + set);
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
