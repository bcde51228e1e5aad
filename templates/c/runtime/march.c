/* march.c: joints on a window: their matrices, how they move, what they send. It stands in generated files
 * twice, for one set of parameters and for many in lanes: `num` is a number of each set, OF(name) what is called name.
 * Plain C of a program of a scene called `name`; what stands below the first empty line. */
#ifndef num
#include "joints.c"
#endif

typedef num OF(track_of)[NAME_PANELS][NAME_ROW];

/* c = a b, of n rows and columns */
static void OF(multiply)(const num *a, const num *b, int n, num *c)
{
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            num sum = ZERO;
            for (int k = 0; k < n; ++k) {
                sum += a[i * n + k] * b[k * n + j];
            }
            c[i * n + j] = sum;
        }
    }
}

/* y += factor a x */
WITHIN void OF(add_product)(const num *a, const num *x, int n, real factor, num *y)
{
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            y[i] += factor * (a[i * n + k] * x[k]);
        }
    }
}

/* Put the larger of two first numbers of rows where it is divided by. */
static void OF(exchange)(num *a, num *b, int n, int one, int other)
{
    const num x = a[one * n + one], y = a[other * n + one];
    const num first = SIZE(x), second = SIZE(y);
    for (int j = 0; j < n; ++j) {
        const num u = a[one * n + j], v = b[one * n + j], w = a[other * n + j], z = b[other * n + j];
        a[one * n + j] = PICK(second > first, w, u);
        a[other * n + j] = PICK(second > first, u, w);
        b[one * n + j] = PICK(second > first, z, v);
        b[other * n + j] = PICK(second > first, v, z);
    }
}

/* The inverse of a, which is lost; where there is none it is no number. */
static void OF(invert)(num *a, int n, num *b)
{
    for (int i = 0; i < n * n; ++i) {
        b[i] = ZERO + (i % (n + 1) == 0 ? (real)1 : (real)0);
    }
    for (int k = 0; k < n; ++k) {
        for (int i = k + 1; i < n; ++i) {
            OF(exchange)(a, b, n, k, i);
        }
        const num first = 1 / a[k * n + k];
        for (int j = 0; j < n; ++j) {
            a[k * n + j] *= first;
            b[k * n + j] *= first;
        }
        for (int i = 0; i < n; ++i) {
            const num factor = a[i * n + k];
            for (int j = 0; i != k && j < n; ++j) {
                a[i * n + j] -= factor * a[k * n + j];
                b[i * n + j] -= factor * b[k * n + j];
            }
        }
    }
}

/* With x' = rates x + f on a panel, x and f series, 2 k x_k + G (x_(k-1) - x_(k+1)) = r_k, G = -half the length times
 * rates: eliminated from the highest k down, where x_0 counts twice. */
static void OF(tabulate_joint)(OF(work_of) *m, const OF(laws) *law, int joint, int panel, int degree)
{
    const int n = states_of(joint);
    num g[NAME_WIDEST * NAME_WIDEST], d[NAME_WIDEST * NAME_WIDEST], found[NAME_WIDEST * NAME_WIDEST];
    for (int i = 0; i < n * n; ++i) {
        g[i] = -half_length[panel] * law->rates[at_rates[joint] + i];
        for (int kind = SOLVE; kind <= LAST; ++kind) {
            m->solver[panel][kind][square_at(joint, degree + 1) + (size_t)i] = ZERO;
        }
    }
    for (int k = degree; k >= 0; --k) {
        const size_t here = square_at(joint, k), above = square_at(joint, k + 1);
        const num *const down = m->solver[panel][DOWN] + above;
        for (int end = FIRST; end <= LAST; ++end) {
            num *const now = m->solver[panel][end] + here;
            OF(multiply)(m->solver[panel][end] + above, down, n, now);
            for (int i = 0; i < n * n; ++i) {
                const real one = i % (n + 1) > 0 ? (real)0 : end == FIRST && k % 2 ? (real)-1 : (real)1;
                now[i] = one - (real)(k == 0 ? 2 : 1) * now[i];
            }
        }
        if (k == 0) {
            for (int i = 0; i < n * n; ++i) {
                d[i] = m->solver[panel][FIRST][here + (size_t)i];
                m->edge[panel][END][at_square[joint] + i] = m->solver[panel][LAST][here + (size_t)i];
            }
            OF(invert)(d, n, m->edge[panel][START] + at_square[joint]);
            continue;
        }
        OF(multiply)(g, down, n, d);
        for (int i = 0; i < n; ++i) {
            d[i * n + i] += (real)(2 * k);
        }
        OF(invert)(d, n, found);
        OF(multiply)(found, g, n, m->solver[panel][DOWN] + here);
        for (int i = 0; i < n * n; ++i) {
            m->solver[panel][SOLVE][here + (size_t)i] = found[i];
        }
    }
}

/* Tables of bodies, at most BODIES_AT_ONCE of them: rates and drives, which table[0] has, and lengths of panels. */
typedef struct {
    int count;
    real length[BODIES_AT_ONCE];
    num (*table[BODIES_AT_ONCE])[4];
} OF(bodies);

/* With q' = -g q + pushed s on a panel, x_k = g length / (4 k) and drive = pushed / g, the elimination of
 * q_k + x_k (q_(k-1) - q_(k+1)) = x_k drive (s_(k-1) - s_(k+1)) from the highest k down. One alone is done twice. */
static void OF(tabulate_bodies)(OF(bodies) *b, int degree)
{
    num step[BODIES_AT_ONCE], drive[BODIES_AT_ONCE];
    num own[BODIES_AT_ONCE], first_own[BODIES_AT_ONCE], last_own[BODIES_AT_ONCE];
    num(*table[BODIES_AT_ONCE])[4];
    UNROLLED
    for (int j = 0; j < BODIES_AT_ONCE; ++j) {
        const int of = j < b->count ? j : 0;
        table[j] = b->table[of];
        step[j] = table[j][0][RATE] * b->length[of];
        drive[j] = table[j][0][DRIVE];
        own[j] = first_own[j] = last_own[j] = ZERO;
    }
    for (int k = degree; k > 0; --k) {
        UNROLLED
        for (int j = 0; j < BODIES_AT_ONCE; ++j) {
            const num above = own[j];
            own[j] = step[j] / ((real)(4 * k) + step[j] * above);
            first_own[j] = (real)(k % 2 ? -1 : 1) - above * first_own[j];
            last_own[j] = 1 - above * last_own[j];
            table[j][k][GAIN] = own[j] * drive[j];
            table[j][k][RATIO] = own[j];
            table[j][k][SUM_FIRST] = first_own[j];
            table[j][k][SUM_LAST] = last_own[j];
        }
    }
    for (int j = 0; j < BODIES_AT_ONCE; ++j) {
        const num less = 2 * own[j] * first_own[j];
        table[j][0][SLACK] = -less / (1 - less);
        table[j][0][LOSS] = 2 * own[j] * last_own[j];
    }
    b->count = 0;
}

static void OF(tabulate)(OF(work_of) *all, const OF(laws) *law, int sets, int degree)
{
    OF(bodies) some;
    some.count = 0;
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int body = 0; body < NAME_BODIES; ++body) {
            const int joint = body_joint[body];
            for (int set = 0; set < sets; ++set) {
                num(*const table)[4] = all[set].body[panel][body];
                table[0][RATE] = -law[set].rates[at_rates[joint]];
                table[0][DRIVE] = law[set].pushed[at_pushed[joint]] / table[0][RATE];
                some.length[some.count] = 2 * half_length[panel];
                some.table[some.count] = table;
                some.count += 1;
                if (some.count == BODIES_AT_ONCE) {
                    OF(tabulate_bodies)(&some, degree);
                }
            }
        }
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            for (int set = 0; set < sets && is_block(joint); ++set) {
                OF(tabulate_joint)(all + set, law + set, joint, panel, degree);
            }
        }
    }
    if (some.count > 0) {
        OF(tabulate_bodies)(&some, degree);
    }
}

/* Up to BODIES_AT_ONCE bodies, of one or several sets: their tables, what acts on them, with nothing at degree + 1, how they
 * move, and their velocity, which goes from its start to its end. */
typedef struct {
    int count;
    num (*table[BODIES_AT_ONCE])[4];
    const num *s[BODIES_AT_ONCE];
    num *q[BODIES_AT_ONCE];
    num *state[BODIES_AT_ONCE];
} OF(moving);

/* One alone is moved twice. */
static void OF(move_bodies)(OF(moving) *b, int degree)
{
    num y[BODIES_AT_ONCE], begun_at[BODIES_AT_ONCE], ended_at[BODIES_AT_ONCE];
    num(*table[BODIES_AT_ONCE])[4];
    const num *s[BODIES_AT_ONCE];
    num *q[BODIES_AT_ONCE];
    UNROLLED
    for (int j = 0; j < BODIES_AT_ONCE; ++j) {
        const int of = j < b->count ? j : 0;
        table[j] = b->table[of];
        s[j] = b->s[of];
        q[j] = b->q[of];
        y[j] = begun_at[j] = ended_at[j] = ZERO;
    }
    for (int k = degree; k > 0; --k) {
        UNROLLED
        for (int j = 0; j < BODIES_AT_ONCE; ++j) {
            const num change = (k == 1 ? (num)(2 * s[j][0]) : s[j][k - 1]) - s[j][k + 1];
            y[j] = table[j][k][GAIN] * change + table[j][k][RATIO] * y[j];
            q[j][k] = y[j];
            begun_at[j] += table[j][k][SUM_FIRST] * y[j];
            ended_at[j] += table[j][k][SUM_LAST] * y[j];
        }
    }
    for (int j = 0; j < BODIES_AT_ONCE; ++j) {
        if (j < b->count) {
            const num rest = *b->state[j] - begun_at[j];
            q[j][0] = rest - table[j][0][SLACK] * rest;
            q[j][degree + 1] = ZERO;
            *b->state[j] = q[j][0] + (ended_at[j] - table[j][0][LOSS] * q[j][0]);
        }
    }
    for (int j = 0; j < BODIES_AT_ONCE; ++j) {
        y[j] = 2 * q[j][0];
    }
    for (int k = 1; k <= degree; ++k) {
        UNROLLED
        for (int j = 0; j < BODIES_AT_ONCE; ++j) {
            y[j] = q[j][k] - table[j][k][RATIO] * y[j];
        }
        UNROLLED
        for (int j = 0; j < BODIES_AT_ONCE; ++j) {
            q[j][k] = y[j];
        }
    }
    b->count = 0;
}

/* Waves at first, as series of so many numbers. */
static void OF(start_waves)(OF(track_of) *waves, const OF(laws) *law, int count)
{
    for (int track = 0; track < NAME_TRACKS; ++track) {
        for (int place = ring[track]; place <= ring[track] + steps[track]; ++place) {
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                for (int k = 0; k < count; ++k) {
                    waves[place][panel][k] = k == 0 ? law->held[track] : ZERO;
                }
            }
        }
    }
}

/* What acts on the points of a joint on a panel, as series, with nothing at degree + 1. */
static void OF(gather)(OF(track_of) *waves, num (*force)[3], const OF(laws) *law, int joint, int panel,
                       const places *now, int degree, int more, num (*acting)[NAME_ROW])
{
    const int first = first_point[joint];
    for (int point = first; point < first_point[joint + 1]; ++point) {
        for (int k = 0; k <= degree + 1; ++k) {
            acting[point][k] = more ? acting[point][k] : ZERO;
        }
        for (int k = 0; k < 3 && force && force_on[point] >= 0; ++k) {
            acting[point][k] += force[force_on[point]][k];
        }
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const num *const a = waves[now->arrived[arrive[port]]][panel];
        num *const s = acting[first + point_of[port]];
        const num factor = law->push[port];
        for (int k = 0; k <= degree; ++k) {
            s[k] += factor * a[k];
        }
    }
}

/* f = matrix * series, or f += where there is `more`, of `rows` times `columns` numbers. */
static void OF(add_series)(const num *matrix, int rows, int columns, num (*series)[NAME_ROW], int degree, int more,
                           num (*f)[NAME_ROW])
{
    for (int i = 0; i < rows; ++i) {
        f[i][degree + 1] = more ? f[i][degree + 1] : ZERO;
        for (int j = 0; j < columns; ++j) {
            const num factor = matrix[i * columns + j];
            if (more || j > 0) {
                for (int k = 0; k <= degree; ++k) {
                    f[i][k] += factor * series[j][k];
                }
            } else {
                for (int k = 0; k <= degree; ++k) {
                    f[i][k] = factor * series[j][k];
                }
            }
        }
    }
}

/* How the states of a joint move on a panel under f: the series x; `state` goes from its start to its end. */
static void OF(moved)(const OF(work_of) *m, int joint, int panel, int degree, num (*f)[NAME_ROW], num *state,
                      num (*x)[NAME_ROW])
{
    const int n = states_of(joint);
    const real half = half_length[panel];
    if (!is_block(joint)) {
        return;
    }
    num y[NAME_WIDEST], r[NAME_WIDEST], begun_at[NAME_WIDEST], ended_at[NAME_WIDEST];
    for (int i = 0; i < n; ++i) {
        y[i] = ZERO;
        begun_at[i] = state[i];
        ended_at[i] = ZERO;
    }
    for (int k = degree; k > 0; --k) {
        const size_t here = square_at(joint, k);
        num now[NAME_WIDEST];
        for (int i = 0; i < n; ++i) {
            r[i] = half * ((k == 1 ? (num)(2 * f[i][0]) : f[i][k - 1]) - f[i][k + 1]);
            now[i] = ZERO;
        }
        OF(add_product)(m->solver[panel][SOLVE] + here, r, n, 1, now);
        OF(add_product)(m->solver[panel][DOWN] + here, y, n, 1, now);
        OF(add_product)(m->solver[panel][FIRST] + here, now, n, -1, begun_at);
        OF(add_product)(m->solver[panel][LAST] + here, now, n, 1, ended_at);
        for (int i = 0; i < n; ++i) {
            y[i] = now[i];
            x[i][k] = now[i];
        }
    }
    num before[NAME_WIDEST];
    for (int i = 0; i < NAME_WIDEST; ++i) { /* all, so that no compiler thinks that a sum begins with nothing */
        before[i] = ZERO;
    }
    OF(add_product)(m->edge[panel][START] + at_square[joint], begun_at, n, 1, before);
    OF(add_product)(m->edge[panel][END] + at_square[joint], before, n, 1, ended_at);
    for (int i = 0; i < n; ++i) {
        x[i][0] = before[i];
        x[i][degree + 1] = ZERO;
        state[i] = ended_at[i];
        before[i] = 2 * before[i];
    }
    for (int k = 1; k <= degree; ++k) {
        num now[NAME_WIDEST];
        for (int i = 0; i < n; ++i) {
            now[i] = x[i][k];
        }
        OF(add_product)(m->solver[panel][DOWN] + square_at(joint, k), before, n, -1, now);
        for (int i = 0; i < n; ++i) {
            x[i][k] = now[i];
            before[i] = now[i];
        }
    }
}

/* What ends send: their points' velocities, less what arrives. */
static void OF(send_out)(OF(track_of) *waves, int joint, int panel, const places *now, int degree, num (*q)[NAME_ROW])
{
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const num *const a = waves[now->arrived[arrive[port]]][panel];
        num *const out = waves[now->sent[send[port]]][panel];
        for (int k = 0; k <= degree; ++k) {
            out[k] = ratio[port] * q[point_of[port]][k] - a[k];
        }
    }
}

/* What the polynomials of a joint miss: the one term of x' = rates x + f that does not fit, as velocities. What a spring
 * misses of its length counts by the acceleration that it makes, for half a panel. */
static void OF(add_missed)(const OF(laws) *law, int joint, int panel, int degree, num (*f)[NAME_ROW],
                           num (*x)[NAME_ROW], num *missed)
{
    const int n = states_of(joint);
    const num *const rates = law->rates + at_rates[joint];
    const real half = half_length[panel];
    for (int i = 0; i < n; ++i) {
        num rest = f[i][degree];
        num weight = ZERO + 1;
        for (int j = 0; j < n; ++j) {
            const num pull = half * rates[j * n + i];
            rest += rates[i * n + j] * x[j][degree];
            if (!is_mass[first_state[joint] + i]) {
                OF(enlarge)(&weight, &pull);
            }
        }
        rest = weight * rest * (half / (real)(2 * (degree + 1)));
        OF(add_magnitude)(missed, &rest);
    }
}

/* What acts on the one point of a joint on a panel, as a series, with nothing at degree + 1. */
static void OF(gather_point)(OF(work_of) *m, const OF(laws) *law, int joint, int panel, const places *now, int degree)
{
    const int first = first_port[joint], end = first_port[joint + 1], force = force_on[first_point[joint]];
    num *const s = m->acting[panel][first_point[joint]];
    const num *const a = m->waves[now->arrived[arrive[first]]][panel];
    const num *const b = m->waves[now->arrived[arrive[end - 1]]][panel];
    const num one = law->push[first], other = end - first > 1 ? law->push[end - 1] : ZERO;
    for (int k = 0; k <= degree; ++k) {
        s[k] = one * a[k] + other * b[k];
    }
    s[degree + 1] = ZERO;
    for (int port = first + 1; port < end - 1; ++port) {
        const num *const c = m->waves[now->arrived[arrive[port]]][panel];
        const num more = law->push[port];
        for (int k = 0; k <= degree; ++k) {
            s[k] += more * c[k];
        }
    }
    for (int k = 0; k < 3 && force >= 0; ++k) {
        s[k] += m->force[panel][force][k];
    }
}

/* What the ends at the one point of a joint send: `times` a series, less what arrives; two ends at once. */
static void OF(send_point)(OF(work_of) *m, int joint, int panel, const places *now, int degree, const num *q,
                           const num *times, num *size)
{
    const int end = first_port[joint + 1];
    for (int port = first_port[joint]; port < end; port += 2) {
        const int next = port + 1 < end ? port + 1 : port;
        const num *const a = m->waves[now->arrived[arrive[port]]][panel];
        const num *const b = m->waves[now->arrived[arrive[next]]][panel];
        num *const left = m->waves[now->sent[send[port]]][panel];
        num *const right = m->waves[now->sent[send[next]]][panel];
        const num one = ratio[port] * *times, other = ratio[next] * *times;
        for (int k = 0; k <= degree; ++k) {
            left[k] = one * q[k] - a[k];
            right[k] = other * q[k] - b[k];
        }
        OF(enlarge)(size, left);
        OF(enlarge)(size, right);
    }
}

/* A point without state between at most two rods, in one pass. */
static void OF(scatter_point)(OF(work_of) *m, const OF(laws) *law, int joint, int panel, const places *now, int degree,
                              num *size)
{
    const int port = first_port[joint], next = first_port[joint + 1] - 1, force = force_on[first_point[joint]];
    const num *const a = m->waves[now->arrived[arrive[port]]][panel];
    const num *const b = m->waves[now->arrived[arrive[next]]][panel];
    num *const left = m->waves[now->sent[send[port]]][panel];
    num *const right = m->waves[now->sent[send[next]]][panel];
    num *const s = m->acting[panel][first_point[joint]];
    const num one = law->push[port], other = next > port ? law->push[next] : ZERO;
    const num times = law->passed[at_passed[joint]], on_left = ratio[port] * times, on_right = ratio[next] * times;
    for (int k = 0; k <= degree; ++k) {
        const num sum = one * a[k] + other * b[k];
        s[k] = sum;
        left[k] = on_left * sum - a[k];
        right[k] = on_right * sum - b[k];
    }
    for (int k = 0; k < 3 && force >= 0; ++k) {
        s[k] += m->force[panel][force][k];
        left[k] = on_left * s[k] - a[k];
        right[k] = on_right * s[k] - b[k];
    }
    OF(enlarge)(size, left);
    OF(enlarge)(size, right);
}

/* Up to BODIES_AT_ONCE bodies, each between at most two rods: as `moving`, with what
 * arrives, times their drives, and what they send. */
typedef struct {
    int count;
    num (*table[BODIES_AT_ONCE])[4];
    const num *a[BODIES_AT_ONCE], *b[BODIES_AT_ONCE], *force[BODIES_AT_ONCE];
    num *left[BODIES_AT_ONCE], *right[BODIES_AT_ONCE];
    num one[BODIES_AT_ONCE], other[BODIES_AT_ONCE];
    real on_left[BODIES_AT_ONCE], on_right[BODIES_AT_ONCE];
    num *q[BODIES_AT_ONCE];
    num *state[BODIES_AT_ONCE];
    num *size[BODIES_AT_ONCE], *missed[BODIES_AT_ONCE];
} OF(between);

/* As move_bodies, all in two passes: for many sets, whose numbers fill vectors as they are. */
static void OF(move_between)(OF(between) *e, real half, int degree)
{
    num y[BODIES_AT_ONCE], begun_at[BODIES_AT_ONCE], ended_at[BODIES_AT_ONCE];
    num above[BODIES_AT_ONCE], here[BODIES_AT_ONCE], highest[BODIES_AT_ONCE], one[BODIES_AT_ONCE], other[BODIES_AT_ONCE];
    num(*table[BODIES_AT_ONCE])[4];
    const num *a[BODIES_AT_ONCE], *b[BODIES_AT_ONCE];
    num *q[BODIES_AT_ONCE], *left[BODIES_AT_ONCE], *right[BODIES_AT_ONCE];
    real on_left[BODIES_AT_ONCE], on_right[BODIES_AT_ONCE];
    UNROLLED
    for (int j = 0; j < BODIES_AT_ONCE; ++j) {
        const int of = j < e->count ? j : 0;
        table[j] = e->table[of];
        a[j] = e->a[of];
        b[j] = e->b[of];
        q[j] = e->q[of];
        left[j] = e->left[of];
        right[j] = e->right[of];
        on_left[j] = e->on_left[of];
        on_right[j] = e->on_right[of];
        one[j] = e->one[of];
        other[j] = e->other[of];
        here[j] = one[j] * a[j][degree] + other[j] * b[j][degree];
        highest[j] = here[j];
        above[j] = y[j] = begun_at[j] = ended_at[j] = ZERO;
    }
    for (int k = degree; k > 0; --k) {
        UNROLLED
        for (int j = 0; j < BODIES_AT_ONCE; ++j) {
            num below = one[j] * a[j][k - 1] + other[j] * b[j][k - 1];
            const num *const force = k <= 3 ? e->force[j < e->count ? j : 0] : NULL;
            if (force) {
                below += table[j][0][DRIVE] * force[k - 1];
            }
            const num change = (k == 1 ? (num)(2 * below) : below) - above[j];
            y[j] = table[j][k][RATIO] * change + table[j][k][RATIO] * y[j];
            q[j][k] = y[j];
            begun_at[j] += table[j][k][SUM_FIRST] * y[j];
            ended_at[j] += table[j][k][SUM_LAST] * y[j];
            above[j] = here[j];
            here[j] = below;
        }
    }
    for (int j = 0; j < e->count; ++j) {
        const num rest = *e->state[j] - begun_at[j];
        const num mean = rest - table[j][0][SLACK] * rest;
        *e->state[j] = mean + (ended_at[j] - table[j][0][LOSS] * mean);
        q[j][0] = mean;
        left[j][0] = on_left[j] * mean - a[j][0];
        right[j][0] = on_right[j] * mean - b[j][0];
        OF(enlarge)(e->size[j], e->state[j]);
        OF(enlarge)(e->size[j], left[j]);
        OF(enlarge)(e->size[j], right[j]);
    }
    for (int j = 0; j < BODIES_AT_ONCE; ++j) {
        y[j] = 2 * q[j][0];
    }
    for (int k = 1; k <= degree; ++k) {
        UNROLLED
        for (int j = 0; j < BODIES_AT_ONCE; ++j) {
            y[j] = q[j][k] - table[j][k][RATIO] * y[j];
            left[j][k] = on_left[j] * y[j] - a[j][k];
            right[j][k] = on_right[j] * y[j] - b[j][k];
        }
    }
    for (int j = 0; j < e->count; ++j) {
        const num rest = (highest[j] - y[j]) * (table[j][0][RATE] * (half / (real)(2 * (degree + 1))));
        OF(add_magnitude)(e->missed[j], &rest);
    }
    e->count = 0;
}

/* Whether bodies of many sets are between at most two rods. */
static int OF(is_between)(int joint)
{
    return FUSED && first_port[joint + 1] - first_port[joint] <= 2;
}

/* All such bodies of some sets on a panel. */
static void OF(march_between)(OF(work_of) *all, const OF(laws) *law, int sets, int panel, const places *now, int degree,
                              num *size, num *missed)
{
    OF(between) some;
    some.count = 0;
    for (int body = 0; body < NAME_BODIES; ++body) {
        const int joint = body_joint[body], force = force_on[first_point[joint]];
        const int port = first_port[joint], next = first_port[joint + 1] - 1;
        for (int set = 0; set < sets && OF(is_between)(joint); ++set) {
            OF(work_of) *const m = all + set;
            const int j = some.count;
            some.table[j] = m->body[panel][body];
            some.a[j] = m->waves[now->arrived[arrive[port]]][panel];
            some.b[j] = m->waves[now->arrived[arrive[next]]][panel];
            some.left[j] = m->waves[now->sent[send[port]]][panel];
            some.right[j] = m->waves[now->sent[send[next]]][panel];
            some.one[j] = m->body[panel][body][0][DRIVE] * law[set].push[port];
            some.other[j] = next > port ? (num)(m->body[panel][body][0][DRIVE] * law[set].push[next]) : ZERO;
            some.on_left[j] = ratio[port];
            some.on_right[j] = ratio[next];
            some.force[j] = force < 0 ? NULL : m->force[panel][force];
            some.q[j] = m->path[panel][first_state[joint]];
            some.state[j] = &m->state[1][first_state[joint]];
            some.size[j] = size + set;
            some.missed[j] = missed + set;
            some.count += 1;
            if (some.count == BODIES_AT_ONCE) {
                OF(move_between)(&some, half_length[panel], degree);
            }
        }
    }
    if (some.count > 0) {
        OF(move_between)(&some, half_length[panel], degree);
    }
}

/* All other bodies of some sets on a panel. */
static void OF(march_bodies)(OF(work_of) *all, const OF(laws) *law, int sets, int panel, const places *now, int degree,
                             num *size, num *missed)
{
    OF(moving) some;
    some.count = 0;
    for (int body = 0; body < NAME_BODIES; ++body) {
        const int joint = body_joint[body];
        for (int set = 0; set < sets && !OF(is_between)(joint); ++set) {
            OF(work_of) *const m = all + set;
            OF(gather_point)(m, law + set, joint, panel, now, degree);
            some.table[some.count] = m->body[panel][body];
            some.s[some.count] = m->acting[panel][first_point[joint]];
            some.q[some.count] = m->path[panel][first_state[joint]];
            some.state[some.count] = &m->state[1][first_state[joint]];
            some.count += 1;
            if (some.count == BODIES_AT_ONCE) {
                OF(move_bodies)(&some, degree);
            }
        }
    }
    if (some.count > 0) {
        OF(move_bodies)(&some, degree);
    }
    for (int body = 0; body < NAME_BODIES; ++body) {
        const int joint = body_joint[body];
        for (int set = 0; set < sets && !OF(is_between)(joint); ++set) {
            OF(work_of) *const m = all + set;
            num(*const table)[4] = m->body[panel][body];
            num(*const q)[NAME_ROW] = m->path[panel] + first_state[joint];
            const num rest = (table[0][DRIVE] * m->acting[panel][first_point[joint]][degree] - q[0][degree]) *
                             (table[0][RATE] * (half_length[panel] / (real)(2 * (degree + 1))));
            const num once = ZERO + 1;
            OF(send_point)(m, joint, panel, now, degree, q[0], &once, size + set);
            OF(add_magnitude)(missed + set, &rest);
            OF(enlarge)(size + set, &m->state[1][first_state[joint]]);
        }
    }
}

/* A joint that is no body. */
static void OF(march_joint)(OF(work_of) *m, const OF(laws) *law, int joint, int panel, const places *now, int degree,
                            num *size, num *missed)
{
    num f[NAME_WIDEST][NAME_ROW];
    num q[NAME_WIDEST][NAME_ROW];
    const int n = states_of(joint), points = points_of(joint), first = first_state[joint];
    num(*const x)[NAME_ROW] = m->path[panel] + first;
    num(*const s)[NAME_ROW] = m->acting[panel] + first_point[joint];
    OF(gather)(m->waves, m->force[panel], law, joint, panel, now, degree, 0, m->acting[panel]);
    if (is_block(joint)) {
        OF(add_series)(law->pushed + at_pushed[joint], n, points, s, degree, 0, f);
        OF(moved)(m, joint, panel, degree, f, m->state[1] + first, x);
        OF(add_missed)(law, joint, panel, degree, f, x, missed);
        OF(add_series)(law->shown + at_shown[joint], points, n, x, degree, 0, q);
    }
    OF(add_series)(law->passed + at_passed[joint], points, points, s, degree, n > 0, q);
    OF(send_out)(m->waves, joint, panel, now, degree, q);
    for (int i = 0; i < n; ++i) {
        if (is_mass[first + i]) {
            OF(enlarge)(size, &m->state[1][first + i]);
        }
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        OF(enlarge)(size, &m->waves[now->sent[send[port]]][panel][0]);
    }
}

/* One window of some sets at a degree. To `missed` is added what its polynomials miss; `size` grows to the largest
 * velocity or mean of a wave. */
static void OF(march)(OF(work_of) *all, const OF(laws) *law, int sets, int window, int degree, num *size, num *missed)
{
    places now;
    placed(window, &now);
    for (int set = 0; set < sets; ++set) {
        for (int k = 0; k < NAME_STATES; ++k) {
            all[set].state[1][k] = all[set].state[0][k];
        }
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        if (FUSED) {
            OF(march_between)(all, law, sets, panel, &now, degree, size, missed);
        }
        OF(march_bodies)(all, law, sets, panel, &now, degree, size, missed);
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            for (int set = 0; set < sets && !is_body[joint]; ++set) {
                if (states_of(joint) < 1 && points_of(joint) == 1 && first_port[joint + 1] - first_port[joint] <= 2) {
                    OF(scatter_point)(all + set, law + set, joint, panel, &now, degree, size + set);
                } else if (states_of(joint) < 1 && points_of(joint) == 1) {
                    OF(gather_point)(all + set, law + set, joint, panel, &now, degree);
                    OF(send_point)(all + set, joint, panel, &now, degree, all[set].acting[panel][first_point[joint]],
                                   &law[set].passed[at_passed[joint]], size + set);
                } else {
                    OF(march_joint)(all + set, law + set, joint, panel, &now, degree, size + set, missed + set);
                }
            }
        }
    }
}
