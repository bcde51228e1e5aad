/* models.h: models of parameters that come at run time: which are tried, and what holds of all of them.
 * Stands above the drivers of such programs. */
#include "fuzz.h"

enum { COUNT = sizeof(name_parameters) / sizeof(name_real) };

/* Those of the scene, some of them changed a little, by powers of two, or to any number. */
static void some_parameters(told *t, name_parameters *set)
{
    name_real all[COUNT];
    memcpy(all, &name_defaults, sizeof all);
    for (int changes = choice(t, COUNT + 1); changes > 0; --changes) {
        const int which = choice(t, COUNT);
        switch (choice(t, 4)) {
        case 0:
            all[which] *= (name_real)1 + (name_real)choice(t, 256) / 256;
            break;
        case 1:
            all[which] *= power_of_two(choice(t, 64) - 32);
            break;
        case 2:
            all[which] = beside(all[choice(t, COUNT)], choice(t, 5) - 2);
            break;
        default:
            all[which] = number(t);
            break;
        }
    }
    memcpy(set, all, sizeof all);
}

/* All coefficients of a model, by their size. */
static name_real sizes(const name_model *model)
{
    name_real sum = 0;
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        const name_real *const series = model->series + model->place[window];
        for (int k = 0; k < NAME_STRANDS * (model->degree[window] + 2); ++k) {
            sum += size_of(series[k]);
        }
    }
    return sum;
}

/* What two ways to add up these may differ by. */
static name_real rounded(const name_model *model)
{
    const name_real least = single ? (name_real)FLT_MIN : (name_real)DBL_MIN;
    return rounding() * NAME_DEGREE * NAME_DEGREE * sizes(model) + least;
}

/* A model where it was built, at tau. */
static void look(const name_model *model, int status, name_real tau, name_real *out)
{
    const name_real estimate = name_error_estimate(model);
    const int refused = name_model_eval(model, tau, out);
    MUST(status >= 0 && status <= 2);
    MUST(status ? estimate != estimate : estimate >= 0);
    MUST(refused == (status || !in_range(tau)));
    MUST(refused ? all_nan(out, NAME_OUTPUTS) : all_finite(out, NAME_OUTPUTS));
}
