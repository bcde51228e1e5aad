/* models.h: what holds of all models of parameters that come at run time. */
#include "parameters.h"

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

/* What values of two models of one set may differ by. */
static name_real apart(const name_model *one, const name_model *other)
{
    return 16 * (name_error_estimate(one) + name_error_estimate(other)) * sizes(one) + rounded(one);
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
