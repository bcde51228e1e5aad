/* bound.c: a proved bound of the errors of a model, from what it sends itself. */
#include "blocks.c"
#include "../root.h"

#if VECTOR > 0
#define LARGER(x, y) ((slice)((((x) > (y)) & (choice)(x)) | (~((x) > (y)) & (choice)(y))))
#else
#define LARGER(x, y) ((x) > (y) ? (x) : (y))
#endif

/* What may be wrong, at most; docs/march.md of wavesym has the proof. In short: let x be how the state of a joint moves.
 * How far x, and what its ends send, are from its law is computed here, rounding included. That starts an error on this
 * panel; the energy of errors, the norm in which masses, springs and waves are squared, never grows afterwards. */
typedef struct {
    real energy;                       /* the norm of all errors so far */
    slice missed;                      /* what joints add to it on a window, lane by lane */
    real instant;                      /* that of the waves on their way, at any one instant of a window */
    real wave[NAME_SLOTS];             /* the largest error of a wave, when it was sent and before */
    slice read[NAME_TRACKS];           /* what reading a wave loses, at most */
    real initial[NAME_TRACKS];         /* what it was at first */
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
    int track[NAME_GAINS + 1];         /* which wave */
    real force[NAME_PANELS][NAME_FORCES + 1]; /* of a load, on this window */
    real load[NAME_FORCES + 1][3], roundings[NAME_FORCES + 1];
    int since[NAME_FORCES + 1][2];
    real reading[NAME_ROW + LANES]; /* of each coefficient of a wave, what it loses on the way to an output */
    real least;                     /* what the first one loses at the lowest degree */
    int degree;
    real total[NAME_GAINS + 1];     /* of an integral, and how large that is */
    real most[NAME_GAINS + 1];
    real largest[NAME_OUTPUTS]; /* where the mean of an output was large */
    int window[NAME_OUTPUTS];
} errors;

static const real alternating[17] = {1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1};

/* No less than the root, and hardly more: Newton's steps end above it, but for rounding. */
static real root_above(real x)
{
    return root(x) * (1 + 4 * unit);
}

/* Nothing, at first. */
static void start_loads(errors *w)
{
    w->degree = -1;
    for (int k = 0; k <= NAME_GAINS; ++k) {
        w->total[k] = w->most[k] = 0;
    }
    for (int f = 0; f <= NAME_FORCES; ++f) {
        w->load[f][0] = w->load[f][1] = w->load[f][2] = 0;
        w->roundings[f] = roundings;
        w->since[f][0] = w->since[f][1] = 0;
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            w->force[panel][f] = 0;
        }
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        w->largest[output] = 0;
        w->window[output] = 0;
    }
}

/* What a coefficient loses where it is read, in `unit`, which is two roundings. T_(j + 1) = 2 u T_j - T_(j - 1) is wrong by
 * 3 roundings more, which T_k has k - j times: 3/4 k (k - 1). u is no more than 2 until 1 goes off: two sums, a product,
 * its factor and the last difference are 9 roundings of u, and |T_k'| is at most k^2: 9/2 k^2. Both are less than
 * 6 (k + 1)(k + 2). The product with T_k and degree + 1 sums are less than degree + 4. Before, it is multiplied by what is
 * rounded, too, and added to others. */
static BY_ITSELF void start_reading(errors *w, int degree)
{
    if (degree > w->degree) {
        for (int k = 0; k < NAME_ROW + LANES; ++k) {
            w->reading[k] = unit * (roundings + (real)(NAME_GAINS + 4 + degree) + 6 * ((real)k + 1) * ((real)k + 2));
        }
        w->least = w->degree < 0 ? w->reading[0] : w->least;
        w->degree = degree;
    }
}

/* As apply_loads, with the absolute values of all that is added. A change is rounded as its law is, and 4 times more. At each
 * later one what acts has 11 roundings: 3 of the time, twice, two products, two sums, and that with the change; 8 `unit`
 * for each are more, as the first one has none of them. In load_series the third power has most roundings: 5 of the
 * middle, twice, a product, a sum, another product, a sum: 14, which are 7 `unit`. */
static void bound_loads(errors *w, const real *change, int window, int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (; is_event(event, window, panel); ++event) {
            const int f = event_force[event];
            const real size = magnitude(change[event]);
            change_load(w->load[f], &size, event, time_since(w->since[f], window, panel));
            w->roundings[f] = (event_power[event] >= 3 ? roundings : w->roundings[f]) + 8;
            w->since[f][0] = window;
            w->since[f][1] = panel;
        }
        for (int f = 0; f < NAME_FORCES; ++f) {
            const real *const c = w->load[f];
            const real time = time_since(w->since[f], window, panel) + 2 * half_length[panel];
            w->force[panel][f] = (w->roundings[f] + 7) * unit * (c[0] + 2 * time * (c[1] + 2 * time * c[2]));
        }
    }
}

/* What the states of a joint are weighed by, and how fast they are where the energy is |x|^2 / 2. */
static real start_joint(const laws *law, errors *w, int joint)
{
    const int n = states_of(joint), first = first_state[joint];
    real most = 0;
    for (int i = first; i < first + n; ++i) {
        w->weight[i] = root_above(law->weight[i] / 2);
        w->reach[i] = w->weight[i] * (2 / law->weight[i]);
        w->end[i] = law->initial[i];
        w->energy += (roundings + 1) * unit * w->weight[i] * magnitude(law->initial[i]);
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
static void start_errors(march_state *m, const laws *law, errors *w)
{
    const real rounded = roundings * unit;
    real steady = 0;
    start_loads(w);
    w->energy = w->instant = w->all = 0;
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        w->length[panel] = root_above(2 * half_length[panel]);
        for (int state = 0; state <= NAME_STATES; ++state) {
            for (int k = 0; k < NAME_ROW; ++k) {
                m->path[panel][state][k] = 0;
            }
        }
    }
    for (int track = 0; track < NAME_TRACKS; ++track) {
        w->read[track] = nothing;
        w->initial[track] = magnitude(law->initial_wave[track]);
        for (int place = ring[track]; place <= ring[track] + steps[track]; ++place) {
            w->wave[place] = rounded * w->initial[track];
        }
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const int n = states_of(joint), first = first_state[joint];
        const real speed = start_joint(law, w, joint);
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            const real fast = speed * (2 * half_length[panel]);
            w->bent[panel][joint] = n > 0 ? root_above(1 + 2 * fast) + 1 + fast : 0;
            for (int i = first; i < first + n; ++i) {
                w->all += w->weight[i] * (w->bent[panel][joint] + 1);
                for (int j = 0; j < points_of(joint); ++j) { /* what acts underflows, too */
                    w->all += w->weight[i] * (2 * half_length[panel]) *
                              magnitude(law->pushed[at_pushed[joint] + (i - first) * points_of(joint) + j]);
                }
            }
        }
        for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
            const real windows = (real)steps[arrive[port]], held = rounded * w->initial[arrive[port]];
            w->passes[port] = root_above(law->impedance[port]);
            w->beyond[port] = 1;
            for (int j = 0; j < points_of(joint); ++j) {
                w->beyond[port] += magnitude(ratio[port] *
                                             law->passed[at_passed[joint] + point_of[port] * points_of(joint) + j]);
            }
            w->all += w->passes[port] * w->beyond[port];
            w->thins[port] = law->impedance[port] > 0 ? w->passes[port] / law->impedance[port] : positive_infinity();
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
    w->steady = root_above(steady);
    for (int t = 0; t < first_term[NAME_STRANDS]; ++t) {
        w->track[term_gain[t]] = term_track[t];
    }
}

/* A sum of products of numbers of a law, `count` of them, with slices of series; and of their magnitudes. */
WITHIN void add_slices(const real *numbers, const slice *series, const slice *sizes, int count, slice *sum, slice *size)
{
    for (int j = 0; j < count; ++j) {
        *sum += numbers[j] * series[j];
        *size += (magnitude(numbers[j]) + faint) * sizes[j];
    }
}

/* Where a joint has what arrives at its ends on a panel, and what these send. */
typedef struct {
    const real *arriving[NAME_PORTS], *sent[NAME_PORTS];
} ends_of_joint;

/* What acts on the points of a joint, from a coefficient on, and what that is the sum of in absolute values. */
WITHIN void acting_slices(const progress *b, const ends_of_joint *at, int joint, int port, int panel, int points, int ends,
                          size_t k, slice *acting, slice *size)
{
    const march_state *const m = b->sets;
    for (int point = 0; point < points; ++point) {
        const int force = force_on[first_point[joint] + point];
        acting[point] = nothing;
        if (k < 3 && force >= 0) {
            UNROLLED
            for (size_t lane = 0; lane < LANES; ++lane) {
                AT(acting[point], lane) = k + lane < 3 ? m->force[panel][force][k + lane] : (real)0;
            }
        }
        size[point] = MAGNITUDE(acting[point]);
    }
    for (int side = 0; side < ends; ++side) {
        const slice pushed = b->law->push[port + side] * *slice_at(at->arriving[side], k);
        const int point = points > 1 ? point_of[port + side] : 0;
        acting[point] += pushed;
        size[point] += MAGNITUDE(pushed);
    }
}

/* What loads may be wrong by, on what rows of a law make of them. */
static real load_error(const errors *w, const real *row, int joint, int panel)
{
    real sum = 0;
    for (int point = 0; point < points_of(joint); ++point) {
        const int force = force_on[first_point[joint] + point];
        sum += force >= 0 ? magnitude(row[point]) * w->force[panel][force] : (real)0;
    }
    return sum;
}

/* What a joint of n states and so many points and ends adds to the energy of errors on a panel, and to what each end sends;
 * of a body nothing that acts passes at once. The sums of x at the ends of a panel lose `few`: each of the lanes, at most
 * 16, adds degree/LANES numbers to its first one, and 4 sums make one of the lanes; a `unit` is one for each end. */
WITHIN void add_residual(const progress *b, const places *now, errors *w, int joint, int panel, int n, int points,
                         int passing, int ends, real *apart)
{
    const march_state *const m = b->sets;
    const laws *const law = b->law;
    const int first = first_state[joint], ports = first_port[joint], degree = b->degree;
    const real half = half_length[panel], few = unit * ((real)(degree / LANES + 4) + 2 * w->bent[panel][joint]);
    const real exact = unit * ((real)(n + points + ends + 10) + 3 * roundings);
    real rate_of[NAME_WIDEST][NAME_ROW + LANES + 1];
    slice x[NAME_WIDEST], x_size[NAME_WIDEST], s[NAME_WIDEST], s_size[NAME_WIDEST];
    slice begins[NAME_WIDEST], last[NAME_WIDEST], sizes[NAME_WIDEST], x_sizes[NAME_WIDEST];
    slice aparts[NAME_PORTS], sums[NAME_PORTS], waves[NAME_PORTS], reads[NAME_PORTS];
    for (int i = 0; i < NAME_WIDEST; ++i) { /* all, so that no compiler thinks that a sum begins with nothing */
        begins[i] = last[i] = sizes[i] = x_sizes[i] = x[i] = x_size[i] = nothing;
    }
    slice *much_of = aparts, *size_of = sums, *wave_of = waves, *read_of = reads;
    ends_of_joint at = {{NULL}, {NULL}};
    const real *rates = law->rates + at_rates[joint], *pushed = law->pushed + at_pushed[joint];
    const real *shown = law->shown + at_shown[joint], *passed = law->passed + at_passed[joint];
    for (int side = 0; side < ends; ++side) {
        aparts[side] = sums[side] = waves[side] = reads[side] = nothing;
        at.arriving[side] = m->waves[now->arrived[arrive[ports + side]]][panel];
        at.sent[side] = m->waves[now->sent[send[ports + side]]][panel];
    }
    size_t end = 0;
    for (; end <= (size_t)degree; end += LANES) {
        int port = ports;
        LOADED_HERE(port);
        LOADED_HERE(rates);
        LOADED_HERE(pushed);
        LOADED_HERE(shown);
        LOADED_HERE(passed);
        if (ends != 2) {
            LOADED_HERE(much_of);
            LOADED_HERE(size_of);
            LOADED_HERE(wave_of);
            LOADED_HERE(read_of);
        }
        acting_slices(b, &at, joint, port, panel, points, ends, end, s, s_size);
        for (int i = 0; i < n; ++i) {
            x[i] = *slice_at(m->path[panel][first + i], end);
            x_size[i] = MAGNITUDE(x[i]);
            begins[i] += *slice_at(alternating, end % 2) * x[i];
            last[i] += x[i];
        }
        for (int i = 0; i < n; ++i) {
            slice sum = nothing, size = nothing;
            add_slices(rates + i * n, x, x_size, n, &sum, &size);
            add_slices(pushed + i * points, s, s_size, points, &sum, &size);
            *(slice *)(rate_of[i] + end) = sum;
            sizes[i] += size;
            x_sizes[i] += x_size[i];
        }
        for (int side = 0; side < ends; ++side) {
            const int row = points > 1 ? point_of[port + side] : 0;
            const slice out = *slice_at(at.sent[side], end), a = *slice_at(at.arriving[side], end);
            const slice out_size = MAGNITUDE(out);
            slice sum = nothing, size = nothing;
            add_slices(shown + row * n, x, x_size, n, &sum, &size);
            add_slices(passed + row * points, s, s_size, passing, &sum, &size);
            const slice much = (out + a) - ratio[port + side] * sum;
            much_of[side] += MAGNITUDE(much);
            size_of[side] += size;
            wave_of[side] += out_size + MAGNITUDE(a);
            read_of[side] += *slice_at(w->reading, end) * out_size;
        }
    }
    for (int i = 0; i < n; ++i) {
        real *const rate = rate_of[i];
        slice rest = nothing;
        rate[0] *= 2;
        for (size_t k = 0; k <= LANES; ++k) {
            rate[end + k] = 0;
        }
        for (size_t k = 1; k <= (size_t)degree + 1; k += LANES) {
            const slice bent = half * *slice_at(b->inverse, k) * (*slice_at(rate, k - 1) - *slice_at(rate, k + 1));
            const slice missed = *slice_at(m->path[panel][first + i], k) - bent;
            rest += MAGNITUDE(missed) + 4 * unit * MAGNITUDE(bent);
        }
        rest = w->bent[panel][joint] * rest + (2 * half * exact * sizes[i] + few * x_sizes[i]);
        w->missed += w->weight[first + i] * rest;
        w->energy += w->weight[first + i] *
                     (magnitude(total_of(&begins[i]) - w->end[first + i]) +
                      2 * half * load_error(w, law->pushed + at_pushed[joint] + i * points, joint, panel));
        w->end[first + i] = total_of(&last[i]);
    }
    for (int side = 0; side < ends; ++side) {
        const int port = ports + side;
        const real beyond = load_error(w, law->passed + at_passed[joint] + point_of[port] * points, joint, panel);
        const slice much = aparts[side] + magnitude(ratio[port]) * exact * sums[side] + unit * 4 * waves[side];
        const real here = total_of(&much) + magnitude(ratio[port]) * beyond;
        w->energy += w->length[panel] * w->passes[port] * here;
        apart[port] = larger(apart[port], here);
        slice *const most = &w->read[send[port]];
        *most = LARGER(reads[side], *most); /* lane by lane: no sum of lanes has been larger */
    }
}

/* The same, as compilers know then: of a body between two ends, of any other, of a point without state, of a block. */
static BY_ITSELF void add_of_body(const progress *b, const places *now, errors *w, int joint, int panel, real *apart)
{
    add_residual(b, now, w, joint, panel, 1, 1, 0, 2, apart);
}

static BY_ITSELF void add_of_hub(const progress *b, const places *now, errors *w, int joint, int panel, int ends,
                                 real *apart)
{
    add_residual(b, now, w, joint, panel, 1, 1, 0, ends, apart);
}

static BY_ITSELF void add_of_point(const progress *b, const places *now, errors *w, int joint, int panel, int ends,
                                   real *apart)
{
    if (ends == 2) {
        add_residual(b, now, w, joint, panel, 0, 1, 1, 2, apart);
    } else {
        add_residual(b, now, w, joint, panel, 0, 1, 1, ends, apart);
    }
}

static BY_ITSELF void add_of_block(const progress *b, const places *now, errors *w, int joint, int panel, int ends,
                                   real *apart)
{
    const int n = states_of(joint), points = points_of(joint);
    add_residual(b, now, w, joint, panel, n, points, points, ends, apart);
}

/* What a window that has been marched adds to the errors, and how large those of its waves are. */
static void add_window(const progress *b, errors *w)
{
    const laws *const law = b->law;
    const int window = b->window;
    const real spare = (real)(256 * (b->degree + 4)) * least_number;
    places now;
    real apart[NAME_PORTS];
    locate(window, &now);
    w->missed = nothing;
    for (int port = 0; port < NAME_PORTS; ++port) {
        apart[port] = 0;
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            const int ends = first_port[joint + 1] - first_port[joint];
            if (is_body[joint] && ends == 2) {
                add_of_body(b, &now, w, joint, panel, apart);
            } else if (is_body[joint]) {
                add_of_hub(b, &now, w, joint, panel, ends, apart);
            } else if (points_of(joint) == 1 && states_of(joint) == 0) {
                add_of_point(b, &now, w, joint, panel, ends, apart);
            } else {
                add_of_block(b, &now, w, joint, panel, ends, apart);
            }
        }
    }
    w->energy += total_of(&w->missed) + spare * w->all;
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
                const real arrived = w->wave[now.arrived[arrive[other]]];
                error += (magnitude(back) + 2 * (roundings + 4) * unit * magnitude(through)) * arrived;
            }
            const real all = w->thins[port] * w->instant;
            error = all < error ? all : error;
            w->energy = finite_number(error) ? w->energy : positive_infinity();
            w->wave[now.sent[send[port]]] = larger(w->wave[slot(send[port], window, 1)], error);
        }
    }
}

/* Of a wave that is heard the largest error so far, and what reading it loses at most. */
static void gain_error(const errors *w, int k, int window, real *error, real *read)
{
    const int track = w->track[k];
    *error = w->wave[slot(track, window, 0)];
    *read = total_of(&w->read[track]) + w->reading[0] * w->initial[track];
}

/* What integrals may be wrong by after a window. */
static void add_integrals(const march_state *m, errors *w, const int *summed, int window, int degree)
{
    const real spare = (real)(64 * (degree + 4) * (NAME_PANELS + 1)) * least_number;
    for (int k = 0; k < NAME_GAINS; ++k) {
        if (summed[k]) {
            real error, read;
            gain_error(w, k, window, &error, &read);
            const real size = window_length * (read / w->least);
            const real total = magnitude(m->total[k]) + size;
            w->most[k] = larger(w->most[k], total);
            w->total[k] += window_length * error + spare +
                                  unit * (2 * (real)(degree + 16) * size + (real)(2 * NAME_PANELS + 2) * total);
        }
    }
}

/* What an output may be wrong by. Nothing that is added up has been larger before the last window than on it. */
static real output_error(const laws *law, const errors *w, const int *summed, int output, int degree)
{
    const real spare = (real)(64 * (degree + 4) * (NAME_PANELS + 1)) * least_number;
    real sum = 0;
    for (int k = 0; k < NAME_GAINS; ++k) {
        if (gain_output[k] == output) {
            real error, read;
            gain_error(w, k, NAME_WINDOWS - 1, &error, &read);
            if (summed[k]) {
                error = w->total[k] + w->reading[0] * w->most[k];
                read = 2 * window_length * read;
            }
            sum += (magnitude(law->gain[k]) + faint) * (error + read) + spare;
        }
    }
    return sum;
}

/* Where an output is larger than before, on a window that ends before TAU_MAX. */
static void note_largest(const march_state *m, errors *w, int window)
{
    const int last = in_cycle(window, 0) + SECTIONS;
    for (int output = 0; output < NAME_OUTPUTS && cycle_begin(window) + from[last] <= NAME_TAU_MAX; ++output) {
        if (m->extremes.largest[output] > w->largest[output]) {
            w->largest[output] = m->extremes.largest[output];
            w->window[output] = window;
        }
    }
}

/* The largest value found of an output, on the section with its largest mean, too. */
static real largest_found(const march_state *m, const name_model *model, const errors *w, int output)
{
    const int window = w->window[output];
    const real *const all = model->series + model->place[window];
    const real begin = cycle_begin(window);
    int section = 0;
    real largest = 0, most = m->extremes.largest[output];
    real t[BLOCK], values[BLOCK];
    for (int of = 0; of < SECTIONS && begin + from[in_cycle(window, of) + 1] <= NAME_TAU_MAX; ++of) {
        real mean;
        mean_of(all, model->degree[window], of * NAME_OUTPUTS + output, &mean);
        if (magnitude(mean) > largest) {
            largest = magnitude(mean);
            section = of;
        }
    }
    const int here = in_cycle(window, section);
    for (int j = 0; j < BLOCK; ++j) {
        t[j] = from[here] + (from[here + 1] - from[here]) * (offset[j] / (real)BLOCK);
    }
    output_block(model, window, section * NAME_OUTPUTS + output, t, values);
    for (int j = 0; j < BLOCK && begin + t[j] <= NAME_TAU_MAX; ++j) {
        most = larger(most, values[j]);
    }
    return most;
}

int name_error_bound_with(
    name_work *work, name_model *model, const name_parameters *parameters, name_real *bound)
{
    march_state *const m = &work->set;
    laws law;
    errors w;
    progress now;
    int summed[NAME_GAINS + 1] = {0};
    int status = start_model(&now, work, model, parameters, &law);
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        bound[output] = not_a_number();
    }
    if (status) {
        return status;
    }
    start_errors(m, &law, &w);
    for (int t = 0; t < first_term[NAME_STRANDS]; ++t) {
        summed[term_gain[t]] = term_summed[t];
    }
    for (int window = 0, event = 0; window < NAME_WINDOWS && next_window(&now); ++window) {
        bound_loads(&w, m->change, window, event);
        start_reading(&w, now.degree);
        add_window(&now, &w);
        keep_window(&now);
        add_integrals(m, &w, summed, window, now.degree);
        note_largest(m, &w, window);
        event = now.event;
    }
    status = finish_model(&now, model, parameters);
    for (int output = 0; output < NAME_OUTPUTS && status == 0; ++output) {
        /* a hundredth for what is of second order in a rounding, and for the roundings of this here */
        const real error = output_error(&law, &w, summed, output, now.degree) * (real)1.01;
        const real size = largest_found(m, model, &w, output);
        const real known = error < size && finite_number(w.energy) ? error / (size - error) * (1 + 4 * unit) : positive_infinity();
        bound[output] = is_zero[output] ? 0 : known;
    }
    return status;
}
