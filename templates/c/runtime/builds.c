/* builds.c: models of parameters, and their derivatives, window by window.
 * Plain C that stands below the text of a march in generated files, which have what stands below the first empty line. */
#ifndef NAME_JOINTED
#include "runtime.c"
#endif

/* What begins a model. 0, or 1 for a bad number. */
static int begun(model_of *m, const name_parameters *parameters, laws *law)
{
    m->built = 0;
    m->estimate = not_a_number();
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
static int next_window(model_of *m, const laws *law, progress *now)
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
static void kept(model_of *m, const laws *law, progress *now)
{
    now->missed += now->leak;
    now->size = now->seen;
    settle(m);
    m->degree[now->window] = now->degree;
    m->place[now->window] = now->place;
    real *const all = m->series + now->place;
    clear(all, now->degree);
    listen(m, m->waves, law->gain, m->total, now->window, now->degree, all);
    look(m, now->window);
    weigh(&now->heard, all, now->degree);
    now->place += (size_t)NAME_STRANDS * (size_t)(now->degree + 2);
    now->window += 1;
}

int name_build(name_model *model, const name_parameters *parameters)
{
    laws law;
    progress now = {0, LEAST, 0, 0, 0, 0, 0, 0, 0};
    int status = begun(model, parameters, &law);
    while (status == 0 && now.window < NAME_WINDOWS) {
        status = next_window(model, &law, &now);
        if (status == 0) {
            kept(model, &law, &now);
        }
    }
    return status ? status : ended(model, &law, &now);
}

/* What begins the derivatives by a parameter. 0, or 1 where they are beyond all numbers. */
static int begun_lane(name_tangent *tangent, const laws *law, const laws *slope, int lane)
{
    if (!laws_within_reach(slope)) {
        return 1;
    }
    for (int event = 0; event < NAME_EVENTS; ++event) {
        const int own = LOAD_LANE >= 0 && lane == LOAD_LANE + event_load[event];
        tangent->change[lane][event] =
            event_weight[event] * (law->load[event_load[event]] * slope->strength[event_strength[event]] +
                                   (own ? law->strength[event_strength[event]] : (real)0));
    }
    started_lane(tangent, slope, lane);
    start_sums(tangent->total[lane], tangent->load[lane], tangent->since[lane]);
    tangent->size[lane][0] = 0;
    return 0;
}

/* The derivatives on a window that has been marched, at a degree that is enough for them, too, or the highest. */
static void follow_all(name_tangent *tangent, const name_parameters *parameters, const laws *law, progress *now, int before)
{
    laws slope;
    for (;;) {
        int late = 0;
        for (int lane = 0; lane < NAME_LANES; ++lane) {
            slopes_of(parameters, lane, &slope);
            const real missed = follow_lane(tangent, law, &slope, lane, now, before);
            late |= !(missed <= (real)LENIENT * share * tangent->size[lane][1]);
        }
        if (!late || now->degree == NAME_DEGREE) {
            break;
        }
        before = now->degree;
        heighten(&tangent->value, law, now);
    }
    for (int lane = 0; lane < NAME_LANES; ++lane) {
        tangent->size[lane][0] = tangent->size[lane][1];
        settle_lane(tangent, lane);
    }
}

int name_build_tangent(name_tangent *tangent, const name_parameters *parameters)
{
    model_of *const m = &tangent->value;
    laws law, slope;
    progress now = {0, LEAST, 0, 0, 0, 0, 0, 0, 0};
    int status = begun(m, parameters, &law);
    status = status || good_for_slopes(parameters) ? status : 1;
    for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
        slopes_of(parameters, lane, &slope);
        status = begun_lane(tangent, &law, &slope, lane);
    }
    while (status == 0 && now.window < NAME_WINDOWS) {
        const int before = now.degree;
        const int first = now.event;
        status = next_window(m, &law, &now);
        for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
            (void)press(tangent->change[lane], tangent->load[lane], tangent->since[lane], tangent->force[lane],
                        now.window, first);
        }
        if (status == 0) {
            follow_all(tangent, parameters, &law, &now, before);
        }
        for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
            real total[NAME_HEARD + 1];
            real *const all = tangent->series[lane] + now.place;
            slopes_of(parameters, lane, &slope);
            clear(all, now.degree);
            listen(m, tangent->waves[lane], law.gain, tangent->total[lane], now.window, now.degree, all);
            /* and where parameters change what outputs weigh, the waves themselves */
            int weighs = 0;
            for (int k = 0; k < NAME_HEARD; ++k) {
                total[k] = m->total[k];
                weighs |= magnitude(slope.gain[k]) > 0;
            }
            if (weighs) {
                listen(m, m->waves, slope.gain, total, now.window, now.degree, all);
            }
            weigh(&now.heard, all, now.degree);
        }
        if (status == 0) {
            kept(m, &law, &now);
        }
    }
    return status ? status : ended(m, &law, &now);
}
