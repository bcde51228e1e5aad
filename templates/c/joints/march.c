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
                m->edge[panel][END][at_rates[joint] + i] = m->solver[panel][LAST][here + (size_t)i];
            }
            OF(invert)(d, n, m->edge[panel][START] + at_rates[joint]);
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

static void OF(tabulate)(OF(work_of) *m, const OF(laws) *law, int degree)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            if (states_of(joint) > 0) {
                OF(tabulate_joint)(m, law, joint, panel, degree);
            }
        }
    }
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
    if (n < 1) {
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
    for (int i = 0; i < n; ++i) {
        before[i] = ZERO;
    }
    OF(add_product)(m->edge[panel][START] + at_rates[joint], begun_at, n, 1, before);
    OF(add_product)(m->edge[panel][END] + at_rates[joint], before, n, 1, ended_at);
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

/* One window at a degree. To `missed` is added what its polynomials miss; `size` grows to the largest velocity or mean of
 * a wave. */
static void OF(march)(OF(work_of) *m, const OF(laws) *law, int window, int degree, num *size, num *missed)
{
    num f[NAME_WIDEST][NAME_ROW];
    num q[NAME_WIDEST][NAME_ROW];
    places now;
    placed(window, &now);
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[1][k] = m->state[0][k];
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            const int n = states_of(joint), points = points_of(joint), first = first_state[joint];
            num(*const x)[NAME_ROW] = m->path[panel] + first;
            num(*const s)[NAME_ROW] = m->acting[panel] + first_point[joint];
            OF(gather)(m->waves, m->force[panel], law, joint, panel, &now, degree, 0, m->acting[panel]);
            if (n > 0) {
                OF(add_series)(law->pushed + at_pushed[joint], n, points, s, degree, 0, f);
                OF(moved)(m, joint, panel, degree, f, m->state[1] + first, x);
                OF(add_missed)(law, joint, panel, degree, f, x, missed);
                OF(add_series)(law->shown + at_shown[joint], points, n, x, degree, 0, q);
            }
            OF(add_series)(law->passed + at_passed[joint], points, points, s, degree, n > 0, q);
            OF(send_out)(m->waves, joint, panel, &now, degree, q);
            for (int i = 0; i < n; ++i) {
                if (is_mass[first + i]) {
                    OF(enlarge)(size, &m->state[1][first + i]);
                }
            }
            for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
                OF(enlarge)(size, &m->waves[now.sent[send[port]]][panel][0]);
            }
        }
    }
}
