/* builds.c: models of parameters, window by window; `m` is what is worked in, `made` the model.
 * Plain C that stands below the text of a march in generated files, which have what stands below the first empty line. */
#include "build.c"

/* What begins a model. 0, or 1 for a bad number. */
static int begun(work_of *m, model_of *made, const name_parameters *parameters, laws *law)
{
    made->built = 0;
    made->estimate = not_a_number();
    if (!good(parameters)) {
        return 1;
    }
    laws_of(parameters, law);
    const int status = refused(law);
    if (status) {
        return status;
    }
    for (int event = 0; event < NAME_EVENTS; ++event) {
        m->change[event] =
            event_weight[event] * law->load[event_load[event]] * law->strength[event_strength[event]];
    }
    start_sums(m->total, m->load, m->since);
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        m->largest[output] = 0;
        m->mean[output] = 0;
    }
    started(m, law);
    return 0;
}

/* The next window, at the lowest degree, raised by quarters, that misses no more than its share. */
static int next_window(work_of *m, const laws *law, progress *now)
{
    now->event = press(m->change, m->load, m->since, m->force, now->window, now->event);
    march_window(m, law, now);
    while (!(now->leak <= share * now->seen)) {
        if (now->degree == NAME_DEGREE) {
            return finite_number(now->leak) && finite_number(now->seen) ? 2 : 1;
        }
        heighten(m, law, now);
    }
    return 0;
}

/* A window that has been marched is good: its outputs; then the next one is due. */
static void kept(work_of *m, model_of *made, const laws *law, progress *now)
{
    now->missed += now->leak;
    now->size = now->seen;
    settle(m);
    made->degree[now->window] = now->degree;
    made->place[now->window] = now->place;
    real *const all = made->series + now->place;
    clear(all, now->degree);
    listen(m, m->waves, law->gain, m->total, now->window, now->degree, all);
    look(made, made->series, now->window, m->mean, m->largest);
    weigh(&now->heard, all, now->degree);
    now->place += (size_t)NAME_STRANDS * (size_t)(now->degree + 2);
    now->window += 1;
}

int name_build_with(name_work *work, name_model *model, const name_parameters *parameters)
{
    laws law;
    progress now = {0, LEAST, 0, 0, 0, 0, 0, 0, 0};
    int status = begun(work, model, parameters, &law);
    while (status == 0 && now.window < NAME_WINDOWS) {
        status = next_window(work, &law, &now);
        if (status == 0) {
            kept(work, model, &law, &now);
        }
    }
    return status ? status : ended(work, model, &law, &now);
}
