/* runtime_joints_bound.c: how wrong the waves of a model of a chain may be, from what it sends itself.
 * Plain C that stands below the text of runtime_joints_wrong.c in generated files, which have what stands below the first empty
 * line. */
#include "runtime_joints_wrong.c"

/* What may be wrong, at most; docs/march.md of wavesym has the proof. In short: let x be how the state of a joint moves.
 * How far x, and what its ends send, are from its law is computed here, rounding included. That starts an error on this
 * panel; the energy of errors, the norm in which masses, springs and waves are squared, never grows afterwards. */
typedef struct {
    real energy;                        /* the norm of all errors so far */
    real wave[NAME_SLOTS];              /* the largest error of a wave, on the window when it was sent */
    real size[NAME_SLOTS][NAME_PANELS]; /* of a wave the sum of its coefficients' magnitudes */
    real end[NAME_STATES + 1], end_error[NAME_STATES + 1];
    real heavy[NAME_STATES + 1], wide[NAME_PORTS]; /* roots of weights and impedances */
    real speed[NAME_JOINTS]; /* the norm of a joint's rates where the energy is |x|^2 / 2 */
    real apart[NAME_PORTS]; /* what is sent beside the law */
    wrong_beside beside;
} wrong;

/* Nothing is wrong but what laws are rounded by. */
static void begun_wrong(wrong *w, const laws *law)
{
    const real rounded = roundings * unit;
    w->energy = 0;
    for (int track = 0; track < NAME_TRACKS; ++track) {
        for (int place = ring[track]; place <= ring[track] + steps[track]; ++place) {
            w->wave[place] = rounded * magnitude(law->held[track]);
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                w->size[place][panel] = magnitude(law->held[track]);
            }
        }
    }
    for (int port = 0; port < NAME_PORTS; ++port) {
        const int track = arrive[port];
        const real length = (real)steps[track] * window_length;
        w->wide[port] = root(law->impedance[port]);
        w->energy += w->wide[port] * root(length) * rounded * magnitude(law->held[track]);
    }
    for (int state = 0; state < NAME_STATES; ++state) {
        w->heavy[state] = root(law->weight[state]);
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const int n = states_of(joint), first = first_state[joint];
        real rows = 0, columns = 0;
        for (int i = 0; i < n; ++i) {
            real row = 0, column = 0;
            for (int j = 0; j < n; ++j) {
                const real one = w->heavy[first + i], other = w->heavy[first + j];
                row += magnitude(law->rates[at_rates[joint] + i * n + j]) * (one / other);
                column += magnitude(law->rates[at_rates[joint] + j * n + i]) * (other / one);
            }
            rows = larger(rows, known(row));
            columns = larger(columns, known(column));
            w->end[first + i] = law->begun[first + i];
            w->end_error[first + i] = rounded * magnitude(law->begun[first + i]);
        }
        w->speed[joint] = root(rows) * root(columns);
    }
    begun_beside(&w->beside);
}

/* What acts on a point on a panel, what that is the sum of in absolute values, and how wrong it may be but for waves. */
static real acting_again(const model_of *m, const laws *law, const wrong *w, int joint, int point, int panel, int window,
                         int degree, real *s, real *wrong_by)
{
    const int force = force_on[point];
    real size = 0, terms = 2;
    for (int k = 0; k <= degree + 1; ++k) {
        s[k] = force >= 0 && k < 3 ? m->force[panel][force][k] : (real)0;
        size += magnitude(s[k]);
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        if (first_point[joint] + point_of[port] == point) {
            const int at = slot(arrive[port], window, steps[arrive[port]]);
            for (int k = 0; k <= degree; ++k) {
                s[k] += law->push[port] * m->waves[at][panel][k];
            }
            size += magnitude(law->push[port]) * w->size[at][panel];
            terms += 1;
        }
    }
    *wrong_by = unit * (roundings + terms) * size + (force >= 0 ? w->beside.force[panel][force] : (real)0) +
                (real)(8 * (degree + 2)) * least_number;
    return size;
}

/* A sum of products of numbers of a law, `count` of them, with series: added to `sum`; what their magnitudes add up to. */
static real sum_again(const real *numbers, const real (*series)[NAME_DEGREE + 2], const real *sizes, int count, int degree,
                      real *sum)
{
    real size = 0;
    for (int j = 0; j < count; ++j) {
        for (int k = 0; k <= degree; ++k) {
            sum[k] += numbers[j] * series[j][k];
        }
        size += magnitude(numbers[j]) * sizes[j];
    }
    return size;
}

/* What a joint adds to the norm of errors on a panel. */
static real defect(const model_of *m, const laws *law, wrong *w, int joint, int panel, int window, int degree)
{
    const int n = states_of(joint), points = points_of(joint), first = first_state[joint], top = first_point[joint];
    const real(*const x)[NAME_DEGREE + 2] = (const real(*)[NAME_DEGREE + 2])(m->path[panel] + first);
    const real half = half_length[panel], length = 2 * half;
    const real exact = unit * ((real)(n + points + 8) + 2 * roundings);
    const real spare = (real)(16 * (degree + 4)) * least_number;
    real s[NAME_WIDEST][NAME_DEGREE + 2], sum[NAME_DEGREE + 2];
    const real(*const given)[NAME_DEGREE + 2] = (const real(*)[NAME_DEGREE + 2])s;
    real size[NAME_WIDEST], beside[NAME_WIDEST], sizes[NAME_WIDEST];
    real missed[NAME_WIDEST], jumped[NAME_WIDEST], forced[NAME_WIDEST], sent[NAME_PORTS];
    for (int i = 0; i < NAME_WIDEST; ++i) {
        size[i] = beside[i] = sizes[i] = 0;
    }
    for (int point = 0; point < points; ++point) {
        size[point] = acting_again(m, law, w, joint, top + point, panel, window, degree, s[point], &beside[point]);
    }
    for (int i = 0; i < n; ++i) {
        sizes[i] = 0;
        for (int k = 0; k <= degree; ++k) {
            sizes[i] += magnitude(x[i][k]);
        }
    }
    for (int i = 0; i < n; ++i) {
        real rest = spare, begin = 0, end = 0, force = spare;
        for (int k = 0; k <= degree + 1; ++k) {
            sum[k] = 0;
        }
        real moved_by = sum_again(law->rates + at_rates[joint] + i * n, x, sizes, n, degree, sum);
        moved_by += sum_again(law->pushed + at_pushed[joint] + i * points, given, size, points, degree, sum);
        for (int k = 1; k <= degree + 1; ++k) {
            const real before = k == 1 ? 2 * sum[0] : sum[k - 1];
            const real after = k < degree ? sum[k + 1] : (real)0;
            const real bent = half * m->inverse[k] * (before - after);
            rest += magnitude((k <= degree ? x[i][k] : (real)0) - bent) + unit * 4 * magnitude(bent);
        }
        for (int k = 0; k <= degree; ++k) {
            begin += k % 2 ? -x[i][k] : x[i][k];
            end += x[i][k];
        }
        const real summing = unit * ((real)degree + 4) * sizes[i] + spare;
        const real jump = magnitude(begin - w->end[first + i]) + unit * magnitude(w->end[first + i]) + summing +
                          w->end_error[first + i];
        for (int point = 0; point < points; ++point) {
            force += magnitude(law->pushed[at_pushed[joint] + i * points + point]) * beside[point];
        }
        w->end[first + i] = end;
        w->end_error[first + i] = summing;
        const real heavy = w->heavy[first + i];
        rest += unit * sizes[i];
        force += exact * moved_by;
        missed[i] = 2 * heavy * rest; /* that at the start counts, too: twice */
        jumped[i] = heavy * jump;
        forced[i] = heavy * force;
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const int point = point_of[port], to = slot(send[port], window, 0);
        const int at = slot(arrive[port], window, steps[arrive[port]]);
        real apart = spare, beyond = 0, all = 0;
        for (int k = 0; k <= degree + 1; ++k) {
            sum[k] = 0;
        }
        real shown_by = sum_again(law->shown + at_shown[joint] + point * n, x, sizes, n, degree, sum);
        shown_by += sum_again(law->passed + at_passed[joint] + point * points, given, size, points, degree, sum);
        for (int k = 0; k <= degree; ++k) {
            const real out = m->waves[to][panel][k];
            apart += magnitude((out + m->waves[at][panel][k]) - ratio[port] * sum[k]);
            all += magnitude(out);
        }
        for (int j = 0; j < points; ++j) {
            beyond += magnitude(law->passed[at_passed[joint] + point * points + j]) * beside[j];
        }
        w->size[to][panel] = all;
        apart += magnitude(ratio[port]) * (exact * shown_by + beyond) + unit * 4 * (all + w->size[at][panel]);
        apart = known(apart);
        w->apart[port] = larger(w->apart[port], apart);
        sent[port - first_port[joint]] = w->wide[port] * apart;
    }
    const real fast = w->speed[joint] * length;
    return norm(missed, n) * (root(fast) + 1 + fast) + norm(jumped, n) + length * norm(forced, n) +
           root(length) * norm(sent, first_port[joint + 1] - first_port[joint]) + spare;
}

/* What a window adds to the errors, and how large those of its waves are. */
static void worsen(const model_of *m, const laws *law, wrong *w, int window, int degree)
{
    for (int port = 0; port < NAME_PORTS; ++port) {
        w->apart[port] = 0;
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            w->energy += defect(m, law, w, joint, panel, window, degree);
        }
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const int n = states_of(joint), points = points_of(joint);
        for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
            const int row = point_of[port];
            real error = w->apart[port];
            for (int i = 0; i < n; ++i) {
                const real shown_by = magnitude(law->shown[at_shown[joint] + row * n + i]);
                error += magnitude(ratio[port]) * shown_by * w->energy * root(2 / law->weight[first_state[joint] + i]);
            }
            for (int other = first_port[joint]; other < first_port[joint + 1]; ++other) {
                const real through = ratio[port] * law->passed[at_passed[joint] + row * points + point_of[other]] *
                                     law->push[other];
                const real back = through - (port == other ? (real)1 : (real)0);
                const real arrived = w->wave[slot(arrive[other], window, steps[arrive[other]])];
                error += (magnitude(back) + 2 * (roundings + 4) * unit * magnitude(through)) * arrived;
            }
            w->wave[slot(send[port], window, 0)] = error;
        }
    }
}

/* Of a wave that is heard on a window the largest error, and its size. */
static void wrong_heard(const model_of *m, const wrong *w, int t, int window, real *error, real *size)
{
    const int at = slot(term_track[t], window, term_back[t]);
    (void)m;
    *error = w->wave[at];
    *size = w->size[at][term_panel[t]];
}
