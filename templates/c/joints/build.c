/* build.c: models of a chain, and their derivatives.
 * Plain C that stands below the text of march.c in generated files, which have what stands below the first
 * empty line. */
#include "march.c"

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

/* For how long what acts on a state is felt on a window: a mass in a dashpot or between bars forgets it before long. */
static real felt_for(const laws *law, int joint, int state)
{
    const real own = magnitude(law->rates[at_rates[joint] + state * (states_of(joint) + 1)]);
    return own * window_length > 1 ? 1 / own : window_length;
}

/* How much of what values are wrong by acts on their derivatives on a window, at most: in velocities, where a spring is
 * longer by a velocity times a window. */
static real felt(const laws *law, const laws *slope)
{
    real most = 0;
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const int n = states_of(joint), points = points_of(joint), first = first_state[joint];
        real acts[NAME_WIDEST], more[NAME_WIDEST];
        real taken[NAME_WIDEST] = {0}; /* so that no compiler thinks that a sum begins with nothing */
        for (int j = 0; j < points; ++j) {
            acts[j] = 0;
            more[j] = 0;
        }
        for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
            acts[point_of[port]] += magnitude(law->push[port]);
            more[point_of[port]] += magnitude(slope->push[port]);
        }
        for (int i = 0; i < n; ++i) {
            real pull = 0;
            for (int j = 0; j < n; ++j) {
                const real length = is_mass[first + j] ? (real)1 : window_length;
                pull += length * magnitude(slope->rates[at_rates[joint] + i * n + j]);
            }
            for (int j = 0; j < points; ++j) {
                const int at = at_pushed[joint] + i * points + j;
                pull += magnitude(slope->pushed[at]) * acts[j] + magnitude(law->pushed[at]) * more[j];
            }
            taken[i] = pull * felt_for(law, joint, i);
        }
        for (int i = 0; i < points; ++i) {
            real sum = 0;
            for (int j = 0; j < n; ++j) {
                const int at = at_shown[joint] + i * n + j;
                const real length = is_mass[first + j] ? (real)1 : window_length;
                sum += magnitude(law->shown[at]) * taken[j] + length * magnitude(slope->shown[at]);
            }
            for (int j = 0; j < points; ++j) {
                const int at = at_passed[joint] + i * points + j;
                sum += magnitude(slope->passed[at]) * acts[j] + magnitude(law->passed[at]) * more[j];
            }
            most = larger(most, sum);
        }
    }
    return most;
}

/* The largest of what acts on the derivatives of a joint as its laws change, before it cancels: of its means. */
static real acting_more(const laws *law, const laws *slope, int joint, real (*x)[NAME_ROW], real (*s)[NAME_ROW])
{
    const int n = states_of(joint), points = points_of(joint);
    real most = 0;
    for (int i = 0; i < n; ++i) {
        real sum = 0;
        for (int j = 0; j < n; ++j) {
            sum += magnitude(slope->rates[at_rates[joint] + i * n + j] * x[j][0]);
        }
        for (int j = 0; j < points; ++j) {
            sum += magnitude(slope->pushed[at_pushed[joint] + i * points + j] * s[j][0]);
        }
        most = larger(most, sum * felt_for(law, joint, i));
    }
    return most;
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
                tangent->acts[lane] = larger(tangent->acts[lane], acting_more(law, slope, joint, x, s));
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

/* What begins a march. */
static void started(model_of *m, const laws *law)
{
    start_waves(m->waves, law);
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = law->begun[k];
    }
    tabulate(m, law, LEAST);
}

/* The next window begins as this one ends. */
static void settle(model_of *m)
{
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = m->state[1][k];
    }
}

/* What begins derivatives by a parameter. */
static void started_lane(name_tangent *tangent, const laws *slope, int lane)
{
    start_waves(tangent->waves[lane], slope);
    for (int k = 0; k < NAME_STATES; ++k) {
        tangent->state[lane][0][k] = slope->begun[k];
    }
}

/* As settle. */
static void settle_lane(name_tangent *tangent, int lane)
{
    for (int k = 0; k < NAME_STATES; ++k) {
        tangent->state[lane][0][k] = tangent->state[lane][1][k];
    }
}

/* Derivatives on the window of now. What their polynomials miss. */
static real follow_lane(name_tangent *tangent, const laws *law, const laws *slope, int lane, const progress *now,
                        int before)
{
    (void)before; /* what a series had not is 0 */
    return follow(tangent, law, slope, lane, now->window, now->degree);
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
