/* sets_bounds.c: proved bounds of many sets of parameters. */
#include "tables.h"

void name_sets_bounds(const name_parameters *parameters, size_t sets, name_model *model, int *status,
                      name_real *estimate, name_real *out);

/* Of each set the status, the estimate, and the bounds: out[set*OUTPUTS + output]. */
void name_sets_bounds(const name_parameters *parameters, size_t sets, name_model *model, int *status,
                      name_real *estimate, name_real *out)
{
    for (size_t set = 0; set < sets; ++set) {
        status[set] = name_error_bound(model, parameters + set, out + set * NAME_OUTPUTS);
        estimate[set] = name_error_estimate(model);
    }
}
