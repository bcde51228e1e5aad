/* runtime_joints_build.c: models of a chain, and their derivatives.
 * Plain C that stands below the text of runtime_joints_march.c in generated files, which have what stands below the first
 * empty line. */
#include "runtime_joints_march.c"

#undef num
#undef OF
#undef PICK
#undef SIZE
#undef ZERO

/* Add to all strands of a window what is heard of waves: each times its gain, or their integrals from tau = 0 on, of
 * which `total` is what windows before have brought. */
static void listen(const model_of *m, track_of *waves, const real *gains, real *total, int window, int degree, real *all)
{
    real sum[NAME_DEGREE + 2];
    for (int s = 0; s < NAME_STRANDS; ++s) {
        real *const c = all + (size_t)s * (size_t)(degree + 2);
        for (int t = first_term[s]; t < first_term[s + 1]; ++t) {
            const real *const w = waves[slot(term_track[t], window, term_back[t])][term_panel[t]];
            const int heard = term_heard[t];
            const real gain = gains[heard];
            if (term_summed[t]) {
                const real length = half_length[term_panel[t]];
                integrate(m, w, degree, sum);
                const real low = length * end_value(sum, degree + 1, term_low[t]);
                c[0] += gain * (total[heard] - low);
                for (int k = 1; k <= degree + 1; ++k) {
                    c[k] += gain * length * sum[k];
                }
                total[heard] += length * end_value(sum, degree + 1, term_high[t]) - low;
            } else {
                for (int k = 0; k <= degree; ++k) {
                    c[k] += gain * w[k];
                }
            }
        }
    }
}

/* One window of the derivatives by a parameter, of which `slope` is what the laws change by: with x' = A x + B s and
 * q = S x + P s,
 *
 *     dx' = A dx + B ds + dA x + dB s,    dq = S dx + P ds + dS x + dP s.
 *
 * What its polynomials miss. */
static real follow(name_tangent *tangent, const laws *law, const laws *slope, int lane, int window, int degree)
{
    model_of *const m = &tangent->value;
    track_of *const waves = tangent->waves[lane];
    real *const size = &tangent->size[lane][1];
    real missed = 0;
    real f[NAME_WIDEST][NAME_ROW];
    real q[NAME_WIDEST][NAME_ROW];
    real dx[NAME_WIDEST][NAME_ROW];
    real acting[NAME_POINTS][NAME_ROW];
    *size = tangent->size[lane][0];
    for (int k = 0; k < NAME_STATES; ++k) {
        tangent->state[lane][1][k] = tangent->state[lane][0][k];
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            const int n = states_of(joint), points = points_of(joint), first = first_state[joint];
            real(*const x)[NAME_ROW] = m->path[panel] + first;
            real(*const s)[NAME_ROW] = m->acting[panel] + first_point[joint];
            real(*const ds)[NAME_ROW] = acting + first_point[joint];
            gather(waves, tangent->force[lane][panel], law, joint, panel, window, degree, 0, acting);
            gather(m->waves, NULL, slope, joint, panel, window, degree, 1, acting);
            empty(q, points, degree);
            if (n > 0) {
                empty(f, n, degree);
                add_series(law->pushed + at_pushed[joint], n, points, ds, degree, f);
                add_series(slope->pushed + at_pushed[joint], n, points, s, degree, f);
                add_series(slope->rates + at_rates[joint], n, n, x, degree, f);
                moved(m, joint, panel, degree, f, tangent->state[lane][1] + first, dx);
                add_missed(law, joint, panel, degree, f, dx, &missed);
                add_series(law->shown + at_shown[joint], points, n, dx, degree, q);
                add_series(slope->shown + at_shown[joint], points, n, x, degree, q);
            }
            add_series(law->passed + at_passed[joint], points, points, ds, degree, q);
            add_series(slope->passed + at_passed[joint], points, points, s, degree, q);
            send_out(waves, joint, panel, window, degree, q);
            for (int i = 0; i < n; ++i) {
                *size = is_mass[first + i] ? larger(*size, tangent->state[lane][1][first + i]) : *size;
            }
            for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
                *size = larger(*size, waves[slot(send[port], window, 0)][panel][0]);
            }
        }
    }
    return missed;
}

/* 0, 1 for a bad number, or 2 for bodies so light, or springs so stiff, that a rounding of how they move on a panel is as
 * much as they move: no degree is enough then, but by chance. */
static int refused(const laws *law)
{
    real fastest = 0;
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
        m->change[event] = event_weight[event] * law->load[event_load[event]] * law->strength[event_strength[event]];
    }
    start_waves(m->waves, law);
    start_sums(m->total, m->load, m->since);
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = law->begun[k];
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        m->largest[output] = 0;
        m->mean[output] = 0;
    }
    tabulate(m, law, LEAST);
    return 0;
}

/* The window of now at the degree of now. */
static void march_window(model_of *m, const laws *law, progress *now)
{
    now->seen = now->size;
    now->leak = 0;
    march(m, law, now->window, now->degree, &now->seen, &now->leak);
}

/* The same at a higher degree. */
static void heighten(model_of *m, const laws *law, progress *now)
{
    now->degree = higher_than(now->degree);
    tabulate(m, law, now->degree);
    march_window(m, law, now);
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
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = m->state[1][k];
    }
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
    start_waves(tangent->waves[lane], slope);
    start_sums(tangent->total[lane], tangent->load[lane], tangent->since[lane]);
    for (int k = 0; k < NAME_STATES; ++k) {
        tangent->state[lane][0][k] = slope->begun[k];
    }
    tangent->size[lane][0] = 0;
    return 0;
}

/* The derivatives on a window that has been marched, at a degree that is enough for them, too, or the highest. */
static void follow_all(name_tangent *tangent, const name_parameters *parameters, const laws *law, progress *now)
{
    laws slope;
    for (;;) {
        int late = 0;
        for (int lane = 0; lane < NAME_LANES; ++lane) {
            slopes_of(parameters, lane, &slope);
            const real missed = follow(tangent, law, &slope, lane, now->window, now->degree);
            late |= !(missed <= (real)LENIENT * share * tangent->size[lane][1]);
        }
        if (!late || now->degree == NAME_DEGREE) {
            break;
        }
        heighten(&tangent->value, law, now);
    }
    for (int lane = 0; lane < NAME_LANES; ++lane) {
        tangent->size[lane][0] = tangent->size[lane][1];
        for (int k = 0; k < NAME_STATES; ++k) {
            tangent->state[lane][0][k] = tangent->state[lane][1][k];
        }
    }
}

int name_build_tangent(name_tangent *tangent, const name_parameters *parameters)
{
    model_of *const m = &tangent->value;
    laws law, slope;
    progress now = {0, LEAST, 0, 0, 0, 0, 0, 0, 0};
    int status = begun(m, parameters, &law);
    for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
        slopes_of(parameters, lane, &slope);
        status = begun_lane(tangent, &law, &slope, lane);
    }
    while (status == 0 && now.window < NAME_WINDOWS) {
        const int first = now.event;
        status = next_window(m, &law, &now);
        for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
            (void)press(tangent->change[lane], tangent->load[lane], tangent->since[lane], tangent->force[lane],
                        now.window, first);
        }
        if (status == 0) {
            follow_all(tangent, parameters, &law, &now);
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
