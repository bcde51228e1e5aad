/* sets_tangents.c: many sets of parameters, with their derivatives. */
#include "tables.h"

void name_sets_tangents(const name_parameters *parameters, size_t sets, name_tangent *tangent, const name_real *tau,
                        int even, size_t count, int *status, name_real *estimate, name_real *out);

/* As name_sets, with derivatives: out[((set*(LANES + 1) + lane)*OUTPUTS + output)*count + k], estimate[set*(LANES + 1) +
 * lane]. */
void name_sets_tangents(const name_parameters *parameters, size_t sets, name_tangent *tangent, const name_real *tau,
                        int even, size_t count, int *status, name_real *estimate, name_real *out)
{
    const size_t rows = (NAME_LANES + 1) * (size_t)NAME_OUTPUTS;
    for (size_t set = 0; set < sets; ++set) {
        name_real *const all = out + set * rows * count;
        status[set] = name_build_tangent(tangent, parameters + set);
        for (size_t lane = 0; lane <= NAME_LANES; ++lane) {
            estimate[set * (NAME_LANES + 1) + lane] = name_tangent_estimate(tangent, (int)lane);
        }
        if (even) {
            (void)name_tangent_sample(tangent, tau[0], tau[1], count, all);
        }
        for (size_t k = 0; !even && k < count; ++k) {
            name_real now[(NAME_LANES + 1) * NAME_OUTPUTS];
            (void)name_tangent_sample(tangent, tau[k], 0, 1, now);
            for (size_t row = 0; row < rows; ++row) {
                all[row * count + k] = now[row];
            }
        }
    }
}
