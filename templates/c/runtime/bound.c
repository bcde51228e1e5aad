/* bound.c: how wrong the waves of a model of a chain may be, from what it sends itself.
 * Plain C that stands below the text of runtime/wrong.c in generated files, which have what stands below the first empty
 * line. */
#include "wrong.c"

/* What may be wrong, at most; docs/march.md of wavesym has the proof. In short: let x be how the state of a joint moves.
 * How far x, and what its ends send, are from its law is computed here, rounding included. That starts an error on this
 * panel; the energy of errors, the norm in which masses, springs and waves are squared, never grows afterwards. */
typedef struct {
    real energy;                       /* the norm of all errors so far */
    real instant;                      /* that of the waves on their way, at any one instant of a window */
    real wave[NAME_SLOTS];             /* the largest error of a wave, when it was sent and before */
    slice read[NAME_TRACKS];           /* what reading a wave loses, at most */
    real held[NAME_TRACKS];            /* what it was at first */
    real end[NAME_STATES + 1];
    real weight[NAME_STATES + 1];      /* root of half a mass or stiffness, and what is no less than 1 over it */
    real reach[NAME_STATES + 1];
    real bent[NAME_PANELS][NAME_JOINTS]; /* the energy of what the integral of a law misses, for weights of 1 */
    real passes[NAME_PORTS], thins[NAME_PORTS]; /* root of an impedance, and what is no less than 1 over it */
    real length[NAME_PANELS];          /* roots of lengths */
    real moves[NAME_PORTS];            /* what an energy of 1 sends */
    real beyond[NAME_PORTS];           /* what underflow in what acts adds to what is sent, for the least number */
    real steady;                       /* and the norm of that */
    real all;                          /* the energy of what underflows */
    int track[NAME_HEARD + 1];         /* which wave is heard */
    wrong_beside beside;
} wrong;

/* What the states of a joint are weighed by, and how fast they are where the energy is |x|^2 / 2. */
static real begun_joint(const laws *law, wrong *w, int joint)
{
    const int n = states_of(joint), first = first_state[joint];
    real most = 0;
    for (int i = first; i < first + n; ++i) {
        w->weight[i] = root(law->weight[i] / 2);
        w->reach[i] = w->weight[i] * (2 / law->weight[i]);
        w->end[i] = law->begun[i];
        w->energy += (roundings + 1) * unit * w->weight[i] * magnitude(law->begun[i]);
    }
    for (int i = 0; i < n; ++i) {
        real row = 0, column = 0;
        for (int j = 0; j < n; ++j) {
            row += w->weight[first + i] * magnitude(law->rates[at_rates[joint] + i * n + j]) * w->reach[first + j];
            column += w->weight[first + j] * magnitude(law->rates[at_rates[joint] + j * n + i]) * w->reach[first + i];
        }
        most = larger(larger(most, row), column);
    }
    return most;
}

/* Nothing is wrong but what laws are rounded by. */
static void begun_wrong(work_of *m, const laws *law, wrong *w)
{
    const real rounded = roundings * unit;
    real steady = 0;
    begun_beside(&w->beside);
    w->energy = w->instant = w->all = 0;
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        w->length[panel] = root(2 * half_length[panel]);
        for (int state = 0; state <= NAME_STATES; ++state) {
            for (int k = 0; k < NAME_ROW; ++k) {
                m->path[panel][state][k] = 0;
            }
        }
    }
    for (int track = 0; track < NAME_TRACKS; ++track) {
        w->read[track] = nothing;
        w->held[track] = magnitude(law->held[track]);
        for (int place = ring[track]; place <= ring[track] + steps[track]; ++place) {
            w->wave[place] = rounded * w->held[track];
        }
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const int n = states_of(joint), first = first_state[joint];
        const real speed = begun_joint(law, w, joint);
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            const real fast = speed * (2 * half_length[panel]);
            w->bent[panel][joint] = n > 0 ? root(1 + 2 * fast) + 1 + fast : 0;
            for (int i = first; i < first + n; ++i) {
                w->all += w->weight[i] * (w->bent[panel][joint] + 1);
                for (int j = 0; j < points_of(joint); ++j) { /* what acts underflows, too */
                    w->all += w->weight[i] * (2 * half_length[panel]) *
                              magnitude(law->pushed[at_pushed[joint] + (i - first) * points_of(joint) + j]);
                }
            }
        }
        for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
            const real windows = (real)steps[arrive[port]], held = rounded * w->held[arrive[port]];
            w->passes[port] = root(law->impedance[port]);
            w->beyond[port] = 1;
            for (int j = 0; j < points_of(joint); ++j) {
                w->beyond[port] += magnitude(ratio[port] *
                                             law->passed[at_passed[joint] + point_of[port] * points_of(joint) + j]);
            }
            w->all += w->passes[port] * w->beyond[port];
            w->thins[port] = law->impedance[port] > 0 ? w->passes[port] / law->impedance[port] : infinity();
            w->moves[port] = 0;
            for (int i = 0; i < n; ++i) {
                const real shown = law->shown[at_shown[joint] + point_of[port] * n + i];
                w->moves[port] += magnitude(ratio[port] * shown) * w->reach[first + i];
            }
            steady += law->impedance[port] * w->moves[port] * w->moves[port];
            w->energy += w->passes[port] * (1 + windows * window_length) * held;
            w->instant += w->passes[port] * windows * held;
        }
    }
    w->steady = root(steady);
    for (int t = 0; t < first_term[NAME_STRANDS]; ++t) {
        w->track[term_heard[t]] = term_track[t];
    }
}

/* A sum of products of numbers of a law, `count` of them, with slices of series; and of their magnitudes. */
static void add_slices(const real *numbers, const slice *series, const slice *sizes, int count, slice *sum, slice *size)
{
    for (int j = 0; j < count; ++j) {
        *sum += numbers[j] * series[j];
        *size += (magnitude(numbers[j]) + faint) * sizes[j];
    }
}

/* What acts on the points of a joint, from a coefficient on, and what that is the sum of in absolute values. */
static void acting_again(const work_of *m, const laws *law, int joint, int panel, int window, size_t k, slice *acting,
                         slice *size)
{
    const int first = first_point[joint];
    for (int point = 0; point < points_of(joint); ++point) {
        const int force = force_on[first + point];
        real load[3 + LANES] = {0};
        for (int power = 0; power < 3 && force >= 0; ++power) {
            load[power] = m->force[panel][force][power];
        }
        acting[point] = k < 3 ? *slice_at(load, k) : nothing;
        size[point] = MAGNITUDE(acting[point]);
    }
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const slice pushed = law->push[port] *
                             *slice_at(m->waves[slot(arrive[port], window, steps[arrive[port]])][panel], k);
        acting[point_of[port]] += pushed;
        size[point_of[port]] += MAGNITUDE(pushed);
    }
}

/* What loads may be wrong by, on what rows of a law make of them. */
static real forced(const wrong *w, const real *row, int joint, int panel)
{
    real sum = 0;
    for (int point = 0; point < points_of(joint); ++point) {
        const int force = force_on[first_point[joint] + point];
        sum += force >= 0 ? magnitude(row[point]) * w->beside.force[panel][force] : (real)0;
    }
    return sum;
}

/* What a joint adds to the energy of errors on a panel. */
static void defect(const work_of *m, const laws *law, wrong *w, int joint, int panel, int window, int degree,
                   slice *energy, real *apart)
{
    const int n = states_of(joint), points = points_of(joint), first = first_state[joint], ports = first_port[joint];
    const real half = half_length[panel], few = unit * ((real)(degree / LANES + 12) + 2 * w->bent[panel][joint]);
    const real exact = unit * ((real)(n + points + first_port[joint + 1] - ports + 10) + 3 * roundings);
    real moved_by[NAME_WIDEST][NAME_ROW + LANES + 1];
    slice x[NAME_WIDEST], x_size[NAME_WIDEST], s[NAME_WIDEST], s_size[NAME_WIDEST];
    slice begins[NAME_WIDEST], ends[NAME_WIDEST], aparts[NAME_PORTS], reads[NAME_PORTS];
    for (int i = 0; i < NAME_WIDEST; ++i) { /* all, so that no compiler thinks that a sum begins with nothing */
        begins[i] = ends[i] = x[i] = x_size[i] = nothing;
    }
    for (int port = ports; port < first_port[joint + 1]; ++port) {
        aparts[port] = reads[port] = nothing;
    }
    size_t end = 0;
    for (; end <= (size_t)degree; end += LANES) {
        acting_again(m, law, joint, panel, window, end, s, s_size);
        for (int i = 0; i < n; ++i) {
            x[i] = *slice_at(m->path[panel][first + i], end);
            x_size[i] = MAGNITUDE(x[i]);
            begins[i] += *slice_at(alternating, end % 2) * x[i];
            ends[i] += x[i];
        }
        for (int i = 0; i < n; ++i) {
            slice sum = nothing, size = nothing;
            add_slices(law->rates + at_rates[joint] + i * n, x, x_size, n, &sum, &size);
            add_slices(law->pushed + at_pushed[joint] + i * points, s, s_size, points, &sum, &size);
            *(slice *)(moved_by[i] + end) = sum;
            *energy += w->weight[first + i] * (2 * half * exact * size + few * x_size[i]);
        }
        for (int port = ports; port < first_port[joint + 1]; ++port) {
            const int row = point_of[port];
            const slice out = *slice_at(m->waves[slot(send[port], window, 0)][panel], end);
            const slice a = *slice_at(m->waves[slot(arrive[port], window, steps[arrive[port]])][panel], end);
            const slice out_size = MAGNITUDE(out);
            slice sum = nothing, size = nothing;
            add_slices(law->shown + at_shown[joint] + row * n, x, x_size, n, &sum, &size);
            add_slices(law->passed + at_passed[joint] + row * points, s, s_size, points, &sum, &size);
            const slice much = (out + a) - ratio[port] * sum;
            aparts[port] += MAGNITUDE(much) + magnitude(ratio[port]) * exact * size + unit * 4 * (out_size + MAGNITUDE(a));
            reads[port] += *slice_at(w->beside.reading, end) * out_size;
        }
    }
    for (int i = 0; i < n; ++i) {
        real *const rate = moved_by[i];
        slice rest = nothing;
        rate[0] *= 2;
        for (size_t k = 0; k <= LANES; ++k) {
            rate[end + k] = 0;
        }
        for (size_t k = 1; k <= (size_t)degree + 1; k += LANES) {
            const slice bent = half * *slice_at(m->inverse, k) * (*slice_at(rate, k - 1) - *slice_at(rate, k + 1));
            const slice missed = *slice_at(m->path[panel][first + i], k) - bent;
            rest += MAGNITUDE(missed) + 4 * unit * MAGNITUDE(bent);
        }
        *energy += w->weight[first + i] * w->bent[panel][joint] * rest;
        w->energy += w->weight[first + i] *
                     (magnitude(total_of(&begins[i]) - w->end[first + i]) +
                      2 * half * forced(w, law->pushed + at_pushed[joint] + i * points, joint, panel));
        w->end[first + i] = total_of(&ends[i]);
    }
    for (int port = ports; port < first_port[joint + 1]; ++port) {
        const real beyond = forced(w, law->passed + at_passed[joint] + point_of[port] * points, joint, panel);
        const real here = total_of(&aparts[port]) + magnitude(ratio[port]) * beyond;
        w->energy += w->length[panel] * w->passes[port] * here;
        apart[port] = larger(apart[port], here);
        slice *const most = &w->read[send[port]];
        *most = LARGER(reads[port], *most); /* lane by lane: no sum of lanes has been larger */
    }
}

/* What a window adds to the errors, and how large those of its waves are. */
static void worsen(const work_of *m, const laws *law, wrong *w, int window, int degree)
{
    const real spare = (real)(256 * (degree + 4)) * least_number;
    slice energy = nothing;
    real apart[NAME_PORTS];
    for (int port = 0; port < NAME_PORTS; ++port) {
        apart[port] = 0;
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            defect(m, law, w, joint, panel, window, degree, &energy, apart);
        }
    }
    w->energy += total_of(&energy) + spare * w->all;
    w->instant += w->steady * w->energy;
    for (int port = 0; port < NAME_PORTS; ++port) {
        apart[port] += spare * w->beyond[port];
        w->instant += w->passes[port] * apart[port];
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const int points = points_of(joint);
        for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
            real error = apart[port] + w->moves[port] * w->energy;
            for (int other = first_port[joint]; other < first_port[joint + 1]; ++other) {
                const real through = ratio[port] *
                                     law->passed[at_passed[joint] + point_of[port] * points + point_of[other]] *
                                     law->push[other];
                const real back = through - (port == other ? (real)1 : (real)0);
                const real arrived = w->wave[slot(arrive[other], window, steps[arrive[other]])];
                error += (magnitude(back) + 2 * (roundings + 4) * unit * magnitude(through)) * arrived;
            }
            const real all = w->thins[port] * w->instant;
            error = all < error ? all : error;
            w->energy = finite_number(error) ? w->energy : infinity();
            w->wave[slot(send[port], window, 0)] = larger(w->wave[slot(send[port], window, 1)], error);
        }
    }
}

/* Of a wave that is heard the largest error so far, and what reading it loses at most. */
static void wrong_heard(const wrong *w, int k, int window, real *error, real *read)
{
    const int track = w->track[k];
    *error = w->wave[slot(track, window, 0)];
    *read = total_of(&w->read[track]) + w->beside.reading[0] * w->held[track];
}
