/* runtime_joints.c: the march of a chain under parameters that come at run time.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "runtime_joints_tables.h"
#define NAME_MARCHED
#include "runtime_series.c"

/* The matrices of a joint for each degree, and two more: x_k = SOLVE r_k + DOWN y_(k+1) - DOWN x_(k-1), FIRST and LAST sum
 * to the state at both ends; START and END belong to x_0. */
enum { SOLVE = 0, DOWN = 1, FIRST = 2, LAST = 3, START = 0, END = 1 };

typedef real track_of[NAME_PANELS][NAME_DEGREE + 1];

/* Where a track has what it had so many windows ago, at most as many as it has steps. */
static int slot(int track, int window, int ago)
{
    const int turn = steps[track] + 1;
    return ring[track] + (window + turn - ago) % turn;
}

/* Ends that stay where they are cancel exactly what reaches them: of a chain an output that is 0 is taken for one that
 * nothing has reached. */
static int reached(const laws *law, int output)
{
    (void)law;
    (void)output;
    return 0;
}

static int states_of(int joint)
{
    return first_state[joint + 1] - first_state[joint];
}

static int points_of(int joint)
{
    return first_point[joint + 1] - first_point[joint];
}

/* Where the matrices of a joint begin, of those of a degree. */
static size_t square_at(int joint, int k)
{
    return (size_t)k * NAME_SQUARES + (size_t)at_rates[joint];
}

/* c = a b, of n rows and columns */
static void multiply(const real *a, const real *b, int n, real *c)
{
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            real sum = 0;
            for (int k = 0; k < n; ++k) {
                sum += a[i * n + k] * b[k * n + j];
            }
            c[i * n + j] = sum;
        }
    }
}

/* y += factor a x */
static void add_product(const real *a, const real *x, int n, real factor, real *y)
{
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            y[i] += factor * (a[i * n + k] * x[k]);
        }
    }
}

/* The inverse of a, which is lost; where there is none it is no number. */
static void invert(real *a, int n, real *b)
{
    for (int i = 0; i < n * n; ++i) {
        b[i] = i % (n + 1) == 0 ? (real)1 : (real)0;
    }
    for (int k = 0; k < n; ++k) {
        int best = k;
        for (int i = k + 1; i < n; ++i) {
            best = magnitude(a[i * n + k]) > magnitude(a[best * n + k]) ? i : best;
        }
        const real first = 1 / a[best * n + k];
        for (int j = 0; j < n; ++j) {
            const real one = a[best * n + j] * first, other = b[best * n + j] * first;
            a[best * n + j] = a[k * n + j];
            b[best * n + j] = b[k * n + j];
            a[k * n + j] = one;
            b[k * n + j] = other;
        }
        for (int i = 0; i < n; ++i) {
            const real factor = a[i * n + k];
            for (int j = 0; i != k && j < n; ++j) {
                a[i * n + j] -= factor * a[k * n + j];
                b[i * n + j] -= factor * b[k * n + j];
            }
        }
    }
}

/* With x' = rates x + f on a panel, x and f series, 2 k x_k + G (x_(k-1) - x_(k+1)) = r_k, G = -half the length times
 * rates: eliminated from the highest k down, where x_0 counts twice. */
static void tabulate_joint(model_of *m, const laws *law, int joint, int panel, int degree)
{
    const int n = states_of(joint);
    real g[NAME_WIDEST * NAME_WIDEST], d[NAME_WIDEST * NAME_WIDEST], found[NAME_WIDEST * NAME_WIDEST];
    for (int i = 0; i < n * n; ++i) {
        g[i] = -half_length[panel] * law->rates[at_rates[joint] + i];
        for (int kind = SOLVE; kind <= LAST; ++kind) {
            m->solver[panel][kind][square_at(joint, degree + 1) + (size_t)i] = 0;
        }
    }
    for (int k = degree; k >= 0; --k) {
        const size_t here = square_at(joint, k), above = square_at(joint, k + 1);
        const real *const down = m->solver[panel][DOWN] + above;
        for (int end = FIRST; end <= LAST; ++end) {
            real *const now = m->solver[panel][end] + here;
            multiply(m->solver[panel][end] + above, down, n, now);
            for (int i = 0; i < n * n; ++i) {
                const real one = i % (n + 1) > 0 ? (real)0 : end == FIRST && k % 2 ? (real)-1 : (real)1;
                now[i] = one - (k == 0 ? 2 : 1) * now[i];
            }
        }
        if (k == 0) {
            for (int i = 0; i < n * n; ++i) {
                d[i] = m->solver[panel][FIRST][here + (size_t)i];
                m->edge[panel][END][at_rates[joint] + i] = m->solver[panel][LAST][here + (size_t)i];
            }
            invert(d, n, m->edge[panel][START] + at_rates[joint]);
            continue;
        }
        multiply(g, down, n, d);
        for (int i = 0; i < n; ++i) {
            d[i * n + i] += (real)(2 * k);
        }
        invert(d, n, found);
        multiply(found, g, n, m->solver[panel][DOWN] + here);
        for (int i = 0; i < n * n; ++i) {
            m->solver[panel][SOLVE][here + (size_t)i] = found[i];
        }
    }
}

static void tabulate(model_of *m, const laws *law, int degree)
{
    for (int k = 1; k <= degree + 1; ++k) {
        m->inverse[k] = 1 / (real)(2 * k);
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            if (states_of(joint) > 0) {
                tabulate_joint(m, law, joint, panel, degree);
            }
        }
    }
}

static void start_waves(track_of *waves, const laws *law)
{
    for (int track = 0; track < NAME_TRACKS; ++track) {
        for (int place = ring[track]; place <= ring[track] + steps[track]; ++place) {
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                for (int k = 0; k <= NAME_DEGREE; ++k) {
                    waves[place][panel][k] = k == 0 ? law->held[track] : (real)0;
                }
            }
        }
    }
}

/* What acts on the points of a joint on a panel, as series, with nothing at degree + 1. */
static void gather(track_of *waves, real (*force)[3], const laws *law, int joint, int panel, int window, int degree,
                   int more, real (*acting)[NAME_DEGREE + 2])
{
    const int first = first_point[joint];
    for (int point = first; point < first_point[joint + 1]; ++point) {
        for (int k = 0; k <= degree + 1; ++k) {
            acting[point][k] = more ? acting[point][k] : (real)0;
        }
        for (int k = 0; k < 3 && force && force_on[point] >= 0; ++k) {
            acting[point][k] += force[force_on[point]][k];
        }
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const real *const a = waves[slot(arrive[port], window, steps[arrive[port]])][panel];
        real *const s = acting[first + point_of[port]];
        const real factor = law->push[port];
        for (int k = 0; k <= degree; ++k) {
            s[k] += factor * a[k];
        }
    }
}

/* f += matrix * series, of `rows` times `columns` numbers */
static void add_series(const real *matrix, int rows, int columns, real (*series)[NAME_DEGREE + 2], int degree,
                       real (*f)[NAME_DEGREE + 2])
{
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            const real factor = matrix[i * columns + j];
            for (int k = 0; k <= degree; ++k) {
                f[i][k] += factor * series[j][k];
            }
        }
    }
}

static void empty(real (*series)[NAME_DEGREE + 2], int rows, int degree)
{
    for (int i = 0; i < rows; ++i) {
        for (int k = 0; k <= degree + 1; ++k) {
            series[i][k] = 0;
        }
    }
}

/* How the states of a joint move on a panel under f: the series x; `state` goes from its start to its end. */
static void moved(const model_of *m, int joint, int panel, int degree, real (*f)[NAME_DEGREE + 2], real *state,
                  real (*x)[NAME_DEGREE + 2])
{
    const int n = states_of(joint);
    const real half = half_length[panel];
    real y[NAME_WIDEST], r[NAME_WIDEST], begun_at[NAME_WIDEST], ended_at[NAME_WIDEST];
    for (int i = 0; i < n; ++i) {
        y[i] = 0;
        begun_at[i] = state[i];
        ended_at[i] = 0;
    }
    for (int k = degree; k > 0; --k) {
        const size_t here = square_at(joint, k);
        real now[NAME_WIDEST];
        for (int i = 0; i < n; ++i) {
            r[i] = half * ((k == 1 ? 2 * f[i][0] : f[i][k - 1]) - f[i][k + 1]);
            now[i] = 0;
        }
        add_product(m->solver[panel][SOLVE] + here, r, n, 1, now);
        add_product(m->solver[panel][DOWN] + here, y, n, 1, now);
        add_product(m->solver[panel][FIRST] + here, now, n, -1, begun_at);
        add_product(m->solver[panel][LAST] + here, now, n, 1, ended_at);
        for (int i = 0; i < n; ++i) {
            y[i] = now[i];
            x[i][k] = now[i];
        }
    }
    real before[NAME_WIDEST];
    for (int i = 0; i < n; ++i) {
        before[i] = 0;
    }
    add_product(m->edge[panel][START] + at_rates[joint], begun_at, n, 1, before);
    add_product(m->edge[panel][END] + at_rates[joint], before, n, 1, ended_at);
    for (int i = 0; i < n; ++i) {
        x[i][0] = before[i];
        x[i][degree + 1] = 0;
        state[i] = ended_at[i];
        before[i] = 2 * before[i];
    }
    for (int k = 1; k <= degree; ++k) {
        real now[NAME_WIDEST];
        for (int i = 0; i < n; ++i) {
            now[i] = x[i][k];
        }
        add_product(m->solver[panel][DOWN] + square_at(joint, k), before, n, -1, now);
        for (int i = 0; i < n; ++i) {
            x[i][k] = now[i];
            before[i] = now[i];
        }
    }
}

/* What ends send: their points' velocities, less what arrives. */
static void send_out(track_of *waves, int joint, int panel, int window, int degree, real (*q)[NAME_DEGREE + 2])
{
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const real *const a = waves[slot(arrive[port], window, steps[arrive[port]])][panel];
        real *const out = waves[slot(send[port], window, 0)][panel];
        for (int k = 0; k <= degree; ++k) {
            out[k] = ratio[port] * q[point_of[port]][k] - a[k];
        }
    }
}

/* What the polynomials of a joint miss: the one term of x' = rates x + f that does not fit, as velocities. What a spring
 * misses of its length counts by the acceleration that it makes, for half a panel. */
static real missed_by(const laws *law, int joint, int panel, int degree, real (*f)[NAME_DEGREE + 2],
                      real (*x)[NAME_DEGREE + 2])
{
    const int n = states_of(joint);
    const real *const rates = law->rates + at_rates[joint];
    const real half = half_length[panel];
    real sum = 0;
    for (int i = 0; i < n; ++i) {
        real rest = f[i][degree];
        real weight = 1;
        for (int j = 0; j < n; ++j) {
            rest += rates[i * n + j] * x[j][degree];
            if (!is_mass[first_state[joint] + i] && half * magnitude(rates[j * n + i]) > weight) {
                weight = half * magnitude(rates[j * n + i]);
            }
        }
        sum += weight * magnitude(rest) * half / (real)(2 * (degree + 1));
    }
    return sum;
}

/* One window at a degree. What its polynomials miss; `size` grows to the largest velocity or mean of a wave. */
static real march(model_of *m, const laws *law, int window, int degree, real *size)
{
    real missed = 0;
    real f[NAME_WIDEST][NAME_DEGREE + 2];
    real q[NAME_WIDEST][NAME_DEGREE + 2];
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[1][k] = m->state[0][k];
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            const int n = states_of(joint), points = points_of(joint), first = first_state[joint];
            real(*const x)[NAME_DEGREE + 2] = m->path[panel] + first;
            real(*const s)[NAME_DEGREE + 2] = m->acting[panel] + first_point[joint];
            gather(m->waves, m->force[panel], law, joint, panel, window, degree, 0, m->acting[panel]);
            empty(q, points, degree);
            if (n > 0) {
                empty(f, n, degree);
                add_series(law->pushed + at_pushed[joint], n, points, s, degree, f);
                moved(m, joint, panel, degree, f, m->state[1] + first, x);
                missed += missed_by(law, joint, panel, degree, f, x);
                add_series(law->shown + at_shown[joint], points, n, x, degree, q);
            }
            add_series(law->passed + at_passed[joint], points, points, s, degree, q);
            send_out(m->waves, joint, panel, window, degree, q);
            for (int i = 0; i < n; ++i) {
                *size = is_mass[first + i] ? larger(*size, m->state[1][first + i]) : *size;
            }
            for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
                *size = larger(*size, m->waves[slot(send[port], window, 0)][panel][0]);
            }
        }
    }
    return missed;
}

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
 *     dx' = A dx + B ds + dA x + dB s,    dq = S dx + P ds + dS x + dP s. */
static void follow(name_tangent *tangent, const laws *law, const laws *slope, int lane, int window, int degree)
{
    model_of *const m = &tangent->value;
    track_of *const waves = tangent->waves[lane];
    real f[NAME_WIDEST][NAME_DEGREE + 2];
    real q[NAME_WIDEST][NAME_DEGREE + 2];
    real dx[NAME_WIDEST][NAME_DEGREE + 2];
    real acting[NAME_POINTS][NAME_DEGREE + 2];
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            const int n = states_of(joint), points = points_of(joint), first = first_state[joint];
            real(*const x)[NAME_DEGREE + 2] = m->path[panel] + first;
            real(*const s)[NAME_DEGREE + 2] = m->acting[panel] + first_point[joint];
            real(*const ds)[NAME_DEGREE + 2] = acting + first_point[joint];
            gather(waves, tangent->force[lane][panel], law, joint, panel, window, degree, 0, acting);
            gather(m->waves, NULL, slope, joint, panel, window, degree, 1, acting);
            empty(q, points, degree);
            if (n > 0) {
                empty(f, n, degree);
                add_series(law->pushed + at_pushed[joint], n, points, ds, degree, f);
                add_series(slope->pushed + at_pushed[joint], n, points, s, degree, f);
                add_series(slope->rates + at_rates[joint], n, n, x, degree, f);
                moved(m, joint, panel, degree, f, tangent->state[lane] + first, dx);
                add_series(law->shown + at_shown[joint], points, n, dx, degree, q);
                add_series(slope->shown + at_shown[joint], points, n, x, degree, q);
            }
            add_series(law->passed + at_passed[joint], points, points, ds, degree, q);
            add_series(slope->passed + at_passed[joint], points, points, s, degree, q);
            send_out(waves, joint, panel, window, degree, q);
        }
    }
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
    if (!laws_within_reach(law)) {
        return 1;
    }
    for (int event = 0; event < NAME_EVENTS; ++event) {
        m->change[event] = law->load[event_load[event]] * law->strength[event_strength[event]];
    }
    start_waves(m->waves, law);
    start_sums(m->total, m->load, m->since);
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = law->begun[k];
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        m->largest[output] = 0;
    }
    tabulate(m, law, LEAST);
    return 0;
}

/* The next window, at the lowest degree, raised by quarters, that misses no more than its share. */
static int next_window(model_of *m, const laws *law, progress *now)
{
    now->event = press(m->change, m->load, m->since, m->force, now->window, now->event);
    for (;;) {
        real seen_so_far = now->size;
        const real leak = march(m, law, now->window, now->degree, &seen_so_far);
        if (leak <= share * seen_so_far) {
            now->missed += leak;
            now->size = seen_so_far;
            break;
        }
        if (now->degree == NAME_DEGREE) {
            return finite_number(leak) && finite_number(seen_so_far) ? 2 : 1;
        }
        const int higher = now->degree + now->degree / 4;
        now->degree = higher < NAME_DEGREE ? higher : NAME_DEGREE;
        tabulate(m, law, now->degree);
    }
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = m->state[1][k];
    }
    m->degree[now->window] = now->degree;
    m->place[now->window] = now->place;
    return 0;
}

/* The outputs on a window that has been marched; then the next one is due. */
static void kept(model_of *m, const laws *law, progress *now)
{
    real *const all = m->series + now->place;
    clear(all, now->degree);
    listen(m, m->waves, law->gain, m->total, now->window, now->degree, all);
    look(m, all, now->degree);
    weigh(&now->heard, all, now->degree);
    now->place += (size_t)NAME_STRANDS * (size_t)(now->degree + 2);
    now->window += 1;
}

int name_build(name_model *model, const name_parameters *parameters)
{
    laws law;
    progress now = {0, LEAST, 0, 0, 0, 0, 0};
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
        tangent->change[lane][event] = law->load[event_load[event]] * slope->strength[event_strength[event]] +
                                       (own ? law->strength[event_strength[event]] : (real)0);
    }
    start_waves(tangent->waves[lane], slope);
    start_sums(tangent->total[lane], tangent->load[lane], tangent->since[lane]);
    for (int k = 0; k < NAME_STATES; ++k) {
        tangent->state[lane][k] = slope->begun[k];
    }
    return 0;
}

int name_build_tangent(name_tangent *tangent, const name_parameters *parameters)
{
    model_of *const m = &tangent->value;
    laws law, slope;
    progress now = {0, LEAST, 0, 0, 0, 0, 0};
    int status = begun(m, parameters, &law);
    for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
        slopes_of(parameters, lane, &slope);
        status = begun_lane(tangent, &law, &slope, lane);
    }
    while (status == 0 && now.window < NAME_WINDOWS) {
        const int first = now.event;
        status = next_window(m, &law, &now);
        for (int lane = 0; lane < NAME_LANES && status == 0; ++lane) {
            real total[NAME_HEARD + 1];
            real *const all = tangent->series[lane] + now.place;
            slopes_of(parameters, lane, &slope);
            (void)press(tangent->change[lane], tangent->load[lane], tangent->since[lane], tangent->force[lane],
                        now.window, first);
            follow(tangent, &law, &slope, lane, now.window, now.degree);
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
