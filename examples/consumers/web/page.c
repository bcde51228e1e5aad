/* What page.html calls: building_m2 with a kappa_1 of its own, and where its values lie. */
#include "building_m2.h"

enum { COUNT = 601 };

static building_m2_model model;
static double rows[BUILDING_M2_OUTPUTS * COUNT];

/* How many values the curve of strain@0.5 has, or 0 where kappa_1 is no number that can be served. */
__attribute__((export_name("solve"))) int solve(double kappa_1)
{
    building_m2_parameters parameters = building_m2_defaults;
    parameters.kappa[1] = kappa_1;
    if (building_m2_build(&model, &parameters) != 0)
        return 0;
    building_m2_model_sample(&model, 0.0, BUILDING_M2_TAU_MAX / (COUNT - 1), COUNT, rows);
    return COUNT;
}

__attribute__((export_name("values"))) const double *values(void)
{
    return rows + (long)BUILDING_M2_STRAIN_0_5 * COUNT;
}
