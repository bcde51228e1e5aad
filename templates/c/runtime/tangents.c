/* tangents.c: models with their derivatives by parameters, built window by window, and their values.
 * Plain C that stands below the text of slopes.c in generated files, which have what stands below the first empty line. */
#include "slopes.c"

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
    tangent->missed[lane] = 0;
    tangent->acts[lane] = 0;
    return 0;
}

/* The derivatives on a window that has been marched, at a degree that is enough for them, too, or the highest. */
static void follow_all(name_tangent *tangent, const name_parameters *parameters, const laws *law, progress *now, int before)
{
    laws slope;
    real missed[NAME_LANES];
    for (;;) {
        int late = 0;
        for (int lane = 0; lane < NAME_LANES; ++lane) {
            slopes_of(parameters, lane, &slope);
            missed[lane] = follow_lane(tangent, law, &slope, lane, now, before);
            late |= !(missed[lane] <= (real)LENIENT * share * tangent->size[lane][1]);
        }
        if (!late || now->degree == NAME_DEGREE) {
            break;
        }
        before = now->degree;
        heighten(&tangent->work, law, now);
    }
    for (int lane = 0; lane < NAME_LANES; ++lane) {
        tangent->size[lane][0] = tangent->size[lane][1];
        tangent->missed[lane] += missed[lane];
        settle_lane(tangent, lane);
    }
}

int name_build_tangent(name_tangent *tangent, const name_parameters *parameters)
{
    work_of *const m = &tangent->work;
    laws law, slope;
    progress now = {0, LEAST, 0, 0, 0, 0, 0, 0, 0};
    tangent->parameters = *parameters;
    tangent->wrong[1] = 0;
    int status = begun(m, &tangent->value, parameters, &law);
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
            kept(m, &tangent->value, &law, &now);
            tangent->wrong[0] = wrong_by(now.missed, now.size, now.degree);
            tangent->wrong[1] += tangent->wrong[0];
        }
    }
    return status ? status : ended(m, &tangent->value, &law, &now);
}

/* The estimate of the derivatives by a parameter: what their own polynomials miss, their own roundings (`acts` is the
 * largest of what acts on them as laws change, which may cancel with loads), and what values are wrong by, which acts on
 * them on every window, as laws change. As errors of windows do not all have one sign, an eighth of that counts;
 * docs/march.md of wavesym has what was measured. */
static real estimated_slope(const name_tangent *tangent, int lane)
{
    const model_of *const m = &tangent->value;
    const int degree = m->degree[NAME_WINDOWS - 1];
    const real size = larger(tangent->size[lane][0], tangent->acts[lane]);
    const real own = wrong_by(tangent->missed[lane], size, degree);
    real mean[NAME_OUTPUTS], largest[NAME_OUTPUTS];
    real worst = 0;
    laws law, slope;
    laws_of(&tangent->parameters, &law);
    slopes_of(&tangent->parameters, lane, &slope);
    const real missed = own + felt(&law, &slope) * tangent->wrong[1] / 8;
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        mean[output] = 0;
        largest[output] = 0;
    }
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        look(m, tangent->series[lane], window, mean, largest);
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        const real error = weight_of(&law, output) * missed + weight_of(&slope, output) * tangent->wrong[0] +
                           read_by(degree) * largest[output];
        worst = larger(worst, relative(&law, &slope, lane, output, error, largest[output]));
    }
    return worst;
}
name_real name_tangent_estimate(const name_tangent *tangent, int lane)
{
    const model_of *const m = &tangent->value;
    if (lane < 0 || lane > NAME_LANES || !m->built) {
        return not_a_number();
    }
    return lane == 0 ? m->estimate : estimated_slope(tangent, lane - 1);
}

int name_tangent_sample(
    const name_tangent *tangent, name_real tau0, name_real dtau, size_t count, name_real *out)
{
    const model_of *const m = &tangent->value;
    int outside = sampled(m, m->series, tau0, dtau, count, out);
    for (size_t lane = 0; lane < NAME_LANES; ++lane) {
        outside |= sampled(m, tangent->series[lane], tau0, dtau, count, out + (lane + 1) * NAME_OUTPUTS * count);
    }
    return outside;
}
