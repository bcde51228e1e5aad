/* slopes.c: the march of a chain for derivatives by parameters.
 * Plain C that stands below the text of runtime/read.c in generated files, which have what stands below the first empty
 * line. */
#include "read.c"

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

/* Which body a joint is. */
static int body_of(int joint)
{
    int body = 0;
    while (body + 1 < NAME_BODIES && body_joint[body] != joint) {
        ++body;
    }
    return body;
}

/* How a body moves on a panel under f = pushed s, which becomes s. */
static void moved_body(work_of *m, int joint, int panel, int degree, real *f, real *state, real *x)
{
    moving one;
    real(*const table)[4] = m->body[panel][body_of(joint)];
    const real pushed = table[0][DRIVE] * table[0][RATE];
    for (int k = 0; k <= degree; ++k) {
        f[k] /= pushed;
    }
    f[degree + 1] = 0;
    one.count = 1;
    one.table[0] = table;
    one.s[0] = f;
    one.q[0] = x;
    one.state[0] = state;
    move_bodies(&one, degree);
    for (int k = 0; k <= degree; ++k) {
        f[k] *= pushed;
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
    work_of *const m = &tangent->work;
    track_of *const waves = tangent->waves[lane];
    real *const size = &tangent->size[lane][1];
    real missed = 0;
    real f[NAME_WIDEST][NAME_ROW];
    real q[NAME_WIDEST][NAME_ROW];
    real dx[NAME_WIDEST][NAME_ROW];
    real acting[NAME_POINTS][NAME_ROW];
    places now;
    placed(window, &now);
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
            gather(waves, tangent->force[lane][panel], law, joint, panel, &now, degree, 0, acting);
            gather(m->waves, NULL, slope, joint, panel, &now, degree, 1, acting);
            if (n > 0) {
                add_series(law->pushed + at_pushed[joint], n, points, ds, degree, 0, f);
                add_series(slope->pushed + at_pushed[joint], n, points, s, degree, 1, f);
                add_series(slope->rates + at_rates[joint], n, n, x, degree, 1, f);
                if (is_body[joint]) {
                    moved_body(m, joint, panel, degree, f[0], tangent->state[lane][1] + first, dx[0]);
                } else {
                    moved(m, joint, panel, degree, f, tangent->state[lane][1] + first, dx);
                }
                add_missed(law, joint, panel, degree, f, dx, &missed);
                tangent->acts[lane] = larger(tangent->acts[lane], acting_more(law, slope, joint, x, s));
                add_series(law->shown + at_shown[joint], points, n, dx, degree, 0, q);
                add_series(slope->shown + at_shown[joint], points, n, x, degree, 1, q);
            }
            add_series(law->passed + at_passed[joint], points, points, ds, degree, n > 0, q);
            add_series(slope->passed + at_passed[joint], points, points, s, degree, 1, q);
            send_out(waves, joint, panel, &now, degree, q);
            for (int i = 0; i < n; ++i) {
                *size = is_mass[first + i] ? larger(*size, tangent->state[lane][1][first + i]) : *size;
            }
            for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
                *size = larger(*size, waves[now.sent[send[port]]][panel][0]);
            }
        }
    }
    return missed;
}

/* What begins derivatives by a parameter. */
static void started_lane(name_tangent *tangent, const laws *slope, int lane)
{
    start_waves(tangent->waves[lane], slope, NAME_ROW);
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
