/* tangents.c: models with their derivatives by parameters: the same march, under what acts as laws change. */
#include "read.c"

/* A derivative may miss so much more of itself than a value. */
enum { LENIENT = 64 };

/* For how long what acts on a state counts on a window: a mass in a dashpot or between bars forgets it before long. */
static real memory_of(const laws *law, int joint, int state)
{
    const real own = magnitude(law->rates[at_rates[joint] + state * (states_of(joint) + 1)]);
    return own * window_length > 1 ? 1 / own : window_length;
}

/* How much errors of values act on their derivatives on a window, at most: in velocities, where a spring is longer by a
 * velocity times a window. */
static real sensitivity(const laws *law, const laws *slope)
{
    real most = 0;
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const int n = NAME_STATES > 0 ? states_of(joint) : 0; /* where there are none no compiler looks for what they have */
        const int points = points_of(joint), first = first_state[joint];
        real acts[NAME_WIDEST] = {0}, more[NAME_WIDEST] = {0}, taken[NAME_WIDEST] = {0};
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
            taken[i] = pull * memory_of(law, joint, i);
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
static real largest_acting(const laws *law, const laws *slope, int joint, real (*x)[NAME_ROW], real (*s)[NAME_ROW])
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
        most = larger(most, sum * memory_of(law, joint, i));
    }
    return most;
}

/* What acts on the derivatives of a joint by a parameter on a panel, as laws change by `slope`: with x' = A x + B s and
 * q = S x + P s,
 *
 *     dx' = A dx + B ds + dA x + dB s,    dq = S dx + P ds + dS x + dP s,
 *
 * where ds has, of values, what arrives. What acts on a body acts on its point. */
static void force_joint(name_tangent *tangent, const laws *law, const laws *slope, int lane, int joint, int panel,
                        const places *now, int degree)
{
    march_state *const m = &tangent->work.set;
    const int n = states_of(joint), points = points_of(joint), first = first_point[joint];
    real s[NAME_WIDEST][NAME_ROW];
    real(*const x)[NAME_ROW] = m->path[panel] + first_state[joint];
    real(*const acting)[NAME_ROW] = tangent->acting[panel] + first;
    real(*const moving)[NAME_ROW] = tangent->moving[panel] + first_state[joint];
    real(*const shifted)[NAME_ROW] = tangent->shifted[panel] + first;
    gather(m, law, NULL, joint, panel, now, degree, 0, s);
    add_series(slope->pushed + at_pushed[joint], n, points, s, degree, 0, moving);
    add_series(slope->rates + at_rates[joint], n, n, x, degree, 1, moving);
    add_series(slope->passed + at_passed[joint], points, points, s, degree, 0, shifted);
    add_series(slope->shown + at_shown[joint], points, n, x, degree, 1, shifted);
    tangent->acts[lane] = larger(tangent->acts[lane], largest_acting(law, slope, joint, x, s));
    for (int point = 0; point < points; ++point) {
        clear(acting[point], degree + SPARE);
        for (int k = 0; k < 3 && NAME_FORCES > 0 && force_on[first + point] >= 0; ++k) {
            acting[point][k] = tangent->lane[lane].force[panel][force_on[first + point]][k];
        }
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        add(acting[point_of[port]], &slope->push[port], m->waves[now->arrived[arrive[port]]][panel], degree);
    }
    if (is_body[joint]) {
        const real inverse = 1 / law->pushed[at_pushed[joint]];
        add(acting[0], &inverse, moving[0], degree);
    }
}

/* One window of the derivatives by a parameter. What its polynomials miss. */
static real march_lane(name_tangent *tangent, const laws *law, const laws *slope, int lane, int window, int degree)
{
    forcing by;
    places now;
    real missed = 0;
    by.acting = tangent->acting;
    by.moving = tangent->moving;
    by.shifted = tangent->shifted;
    locate(window, &now);
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        by.changed[joint] = is_changed(slope, joint);
        for (int panel = 0; panel < NAME_PANELS && by.changed[joint]; ++panel) {
            force_joint(tangent, law, slope, lane, joint, panel, &now, degree);
        }
    }
    tangent->size[lane][1] = tangent->size[lane][0];
    march(tangent->lane + lane, &tangent->work.tables, law, 1, window, degree, &by, &tangent->size[lane][1], &missed);
    return missed;
}

/* The start of the derivatives by a parameter. 0, or 1 where they are beyond all numbers. */
static BY_ITSELF int start_lane(name_tangent *tangent, const laws *law, const laws *slope, int lane)
{
    march_state *const m = tangent->lane + lane;
    for (int event = 0; event < NAME_EVENTS; ++event) {
        const int own = LOAD_LANE >= 0 && lane == LOAD_LANE + event_load[event];
        const real strength = law->strength[event_strength[event]];
        m->change[event] = change_by(law, event, slope->strength[event_strength[event]]) +
                           (own ? event_weight[event] * strength : (real)0);
    }
    start_set(m, slope, NAME_ROW);
    tangent->size[lane][0] = tangent->missed[lane] = tangent->acts[lane] = 0;
    return !laws_within_reach(slope);
}

/* The derivatives on a window of which the values are marched, at a degree that is enough for them, too, or the highest. */
static void march_lanes(name_tangent *tangent, progress *b)
{
    laws slope;
    real missed[NAME_LANES];
    for (int late = 1; late;) {
        late = 0;
        for (int lane = 0; lane < NAME_LANES; ++lane) {
            slopes_of(&tangent->parameters, lane, &slope);
            missed[lane] = march_lane(tangent, b->law, &slope, lane, b->window, b->degree);
            late |= !(missed[lane] <= (real)LENIENT * share * tangent->size[lane][1]) && b->degree < NAME_DEGREE;
        }
        if (late) {
            march_again(b, higher_than(b->degree));
        }
    }
    for (int lane = 0; lane < NAME_LANES; ++lane) {
        tangent->size[lane][0] = tangent->size[lane][1];
        tangent->missed[lane] += missed[lane];
    }
}

/* The outputs' derivatives on such a window. */
static void keep_lane(name_tangent *tangent, progress *b, int lane)
{
    march_state *const m = tangent->lane + lane;
    real *const all = tangent->series[lane] + b->place;
    laws slope;
    slopes_of(&tangent->parameters, lane, &slope);
    accumulate(m, b->inverse, b->law, b->window, b->degree, 0, all, b->weight);
    if (differs(slope.gain, NAME_GAINS)) { /* and the waves themselves, whose integrals have not gone on yet */
        for (int k = 0; k < NAME_GAINS; ++k) {
            tangent->total[k] = b->sets->total[k];
        }
        accumulate(b->sets, b->inverse, &slope, b->window, b->degree, 1, all, b->weight);
        for (int k = 0; k < NAME_GAINS; ++k) {
            b->sets->total[k] = tangent->total[k];
        }
    }
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = m->state[1][k];
    }
}

int name_build_tangent(name_tangent *tangent, const name_parameters *parameters)
{
    laws law, slope;
    progress now;
    int status = start_model(&now, &tangent->work, &tangent->value, parameters, &law);
    status = status || good_for_slopes(parameters) ? status : 1;
    tangent->parameters = *parameters;
    tangent->error[1] = 0;
    for (int f = 0; f <= NAME_FORCES; ++f) {
        tangent->since[f][0] = tangent->since[f][1] = 0;
    }
    for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
        slopes_of(parameters, lane, &slope);
        status = start_lane(tangent, &law, &slope, lane);
    }
    if (status) {
        return status;
    }
    for (int event = 0; now.window < NAME_WINDOWS && next_window(&now);) {
        event = apply_loads(tangent->lane, NAME_LANES, tangent->since, now.window, event);
        march_lanes(tangent, &now);
        for (int lane = 0; lane < NAME_LANES; ++lane) {
            keep_lane(tangent, &now, lane);
        }
        keep_window(&now);
        tangent->error[0] = velocity_error(now.missed[0], now.size[0], now.degree);
        tangent->error[1] += tangent->error[0];
    }
    return finish_model(&now, &tangent->value, parameters);
}

/* The estimate of the derivatives by a parameter: their own truncation and rounding errors (`acts` is the largest of what
 * acts on them as laws change, which may cancel with loads), and the errors of values, which act on them on every window, as
 * laws change. As errors of windows do not all have one sign, an eighth of that counts; docs/march.md of wavesym has what
 * was measured. */
static real estimate_slope(const name_tangent *tangent, int lane)
{
    const name_model *const m = &tangent->value;
    const int degree = m->degree[NAME_WINDOWS - 1];
    const real size = larger(tangent->size[lane][0], tangent->acts[lane]);
    extremes found = {{0}, {0}, {0}};
    real worst = 0;
    laws law, slope;
    laws_of(&tangent->parameters, &law);
    slopes_of(&tangent->parameters, lane, &slope);
    const real missed =
        velocity_error(tangent->missed[lane], size, degree) + sensitivity(&law, &slope) * tangent->error[1] / 8;
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        find_largest(&found, tangent->series[lane] + m->place[window], window, m->degree[window]);
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        const real largest = found.largest[output];
        real weight, more;
        weight_of(&law, output, &weight);
        weight_of(&slope, output, &more);
        const real error = weight * missed + more * tangent->error[0] + read_by(degree) * largest;
        worst = larger(worst, relative_slope(&law, &slope, lane, output, error, largest));
    }
    return worst;
}

name_real name_tangent_estimate(const name_tangent *tangent, int lane)
{
    const name_model *const m = &tangent->value;
    if (lane < 0 || lane > NAME_LANES || !m->built) {
        return not_a_number();
    }
    return lane == 0 ? m->estimate : estimate_slope(tangent, lane - 1);
}

int name_tangent_sample(
    const name_tangent *tangent, name_real tau0, name_real dtau, size_t count, name_real *out)
{
    const name_model *const m = &tangent->value;
    int outside = sample_series(m, m->series, tau0, dtau, count, out);
    for (size_t lane = 0; lane < NAME_LANES; ++lane) {
        outside |= sample_series(m, tangent->series[lane], tau0, dtau, count, out + (lane + 1) * NAME_OUTPUTS * count);
    }
    return outside;
}
