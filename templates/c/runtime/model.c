/* model.c: a model of one set of parameters. */
#include "one.c"
#include "build.c"

/* The laws of parameters. 0, 1 for a bad number, or 2 for bodies so light, or springs so stiff, that a rounding of how they
 * move on a panel is as much as they move: no degree is enough then, but by chance. */
static int check_laws(const name_parameters *parameters, laws *law)
{
    real fastest = 0;
    if (!good(parameters)) {
        return 1;
    }
    laws_of(parameters, law);
    if (!laws_within_reach(law)) {
        return 1;
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const real *const rates = law->rates + at_rates[joint];
        const int n = states_of(joint);
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j <= i; ++j) {
                fastest = larger(fastest, (unit * rates[i * n + j]) * (unit * rates[j * n + i]));
            }
        }
    }
    return window_length * window_length * fastest < 1 ? 0 : 2;
}

/* What an event changes a load by, for each unit of its strength, and of that of the load. */
static real change_by(const laws *law, int event, real strength)
{
    return event_weight[event] * law->load[event_load[event]] * strength;
}

/* The start of a model. 0, or what `build` returns. */
static int start_model(
    progress *b, name_work *work, name_model *model, const name_parameters *parameters, laws *law)
{
    model->built = 0;
    model->estimate = not_a_number();
    b->sets = &work->set;
    b->tables = &work->tables;
    b->law = law;
    b->inverse = work->inverse;
    b->since = work->since;
    b->series = model->series;
    b->degrees = model->degree;
    b->places = model->place;
    b->status[0] = check_laws(parameters, law);
    for (int event = 0; event < NAME_EVENTS && b->status[0] == 0; ++event) {
        work->set.change[event] = change_by(law, event, law->strength[event_strength[event]]);
    }
    if (b->status[0] == 0) {
        start(b);
    }
    return b->status[0];
}

/* Its end, after all windows, or where it is refused. */
static int finish_model(progress *b, name_model *model, const name_parameters *parameters)
{
    finish(b, parameters, &model->estimate);
    model->built = b->status[0] == 0;
    return b->status[0];
}

int name_build_with(name_work *work, name_model *model, const name_parameters *parameters)
{
    laws law;
    progress now;
    int status = start_model(&now, work, model, parameters, &law);
    if (status == 0) {
        march_all(&now);
        status = finish_model(&now, model, parameters);
    }
    return status;
}
