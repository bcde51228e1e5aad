/* batches.c: models of many sets of parameters at once.
 * Plain C that stands below the text of a march in lanes in generated files, which have what stands below the first empty
 * line. */
#include "strands.c"

/* Parts are where sets are, and as large; else this is no type. */
typedef char as_large[sizeof(part_of) == SETS * sizeof(name_set) ? 1 : -1];

static part_of *parts_of(batch_of *b)
{
    return (part_of *)(void *)b->work;
}

/* As press. */
static int press_batch(batch_of *b, int window, int event)
{
    part_of *const all = parts_of(b);
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        while (event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel) {
            const int f = event_force[event];
            const real gone =
                (real)(window - b->since[f][0]) * window_length + since_panel[panel * NAME_PANELS + b->since[f][1]];
            for (int side = 0; side < PARTS; ++side) {
                wide *const c = all[side].load[f];
                c[0] += gone * (c[1] + gone * c[2]);
                c[1] += 2 * gone * c[2];
                for (int k = 0; k < 3 && event_power[event] >= 3; ++k) {
                    c[k] = none;
                }
                c[event_power[event] % 3] += all[side].change[event];
            }
            b->since[f][0] = window;
            b->since[f][1] = panel;
            ++event;
        }
        const real half = half_length[panel];
        for (int f = 0; f < NAME_FORCES; ++f) {
            const real gone =
                (real)(window - b->since[f][0]) * window_length + since_panel[panel * NAME_PANELS + b->since[f][1]];
            const real middle = gone + half;
            for (int side = 0; side < PARTS; ++side) {
                const wide *const c = all[side].load[f];
                wide *const force = all[side].force[panel][f];
                force[0] = (c[0] + middle * c[1]) + (middle * middle + half * half / 2) * c[2];
                force[1] = half * (c[1] + 2 * middle * c[2]);
                force[2] = half * half / 2 * c[2];
            }
        }
    }
    return event;
}

/* A set's laws, and how its loads change, into its lane. */
static void given_batch(batch_of *b, laws_batch *all, int set, const laws *law)
{
    part_of *const p = parts_of(b) + set / SETS;
    spread(all + set / SETS, set % SETS, law);
    for (int event = 0; event < NAME_EVENTS; ++event) {
        AT(p->change[event], set % SETS) =
            event_weight[event] * law->load[event_load[event]] * law->strength[event_strength[event]];
    }
}

/* Nothing gathered, nothing looked at, no load. */
static void clear_part(part_of *p)
{
    for (int k = 0; k < NAME_HEARD; ++k) {
        p->total[k] = none;
    }
    for (int f = 0; f <= NAME_FORCES; ++f) {
        for (int power = 0; power < 3; ++power) {
            p->load[f][power] = none;
        }
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        p->largest[output] = none;
        p->mean[output] = none;
        p->worth[output] = none;
    }
}

/* What begins a batch: how many of its sets are good. */
static int begun_batch(batch_of *b, laws_batch *all, const name_parameters *parameters, size_t sets)
{
    laws law, other;
    int good_ones = 0;
    int good_one[NAME_WIDTH];
    for (int f = 0; f <= NAME_FORCES; ++f) {
        b->since[f][0] = 0;
        b->since[f][1] = 0;
    }
    for (int set = 0; set < NAME_WIDTH; ++set) {
        good_one[set] = 0;
        b->status[set] = 1;
        if ((size_t)set < sets && good(parameters + set)) {
            laws_of(parameters + set, &law);
            b->status[set] = refused(&law);
            good_one[set] = b->status[set] == 0;
        }
        if (good_one[set]) {
            given_batch(b, all, set, &law);
            other = law;
            ++good_ones;
        }
    }
    for (int set = 0; good_ones > 0 && set < NAME_WIDTH; ++set) {
        if (!good_one[set]) {
            given_batch(b, all, set, &other);
        }
    }
    for (int side = 0; good_ones > 0 && side < PARTS; ++side) {
        clear_part(parts_of(b) + side);
        started_batch(parts_of(b) + side, all + side);
    }
    return good_ones;
}

/* Whether a set that is still good misses more than its share; at the highest degree it is refused. */
static int misses(batch_of *b, const wide *leak, const wide *size, int highest)
{
    int found = 0;
    for (int set = 0; set < NAME_WIDTH; ++set) {
        const real missed = OF_SET(leak, set), seen = OF_SET(size, set);
        if (b->status[set] == 0 && !(missed <= share * seen)) {
            found = 1;
            if (highest) {
                b->status[set] = finite_number(missed) && finite_number(seen) ? 2 : 1;
            }
        }
    }
    return found;
}

static void tabulated(batch_of *b, const laws_batch *law, int degree)
{
    tell_inverses(b->inverse, degree + 1);
    tabulate_parts(parts_of(b), law, degree);
}

/* One window at the lowest degree that is enough; the degree. What a refused set would need is not asked of others. */
static int window_batch(batch_of *b, const laws_batch *law, int window, int degree, wide *size, wide *missed)
{
    const int before = degree;
    for (;;) {
        wide seen[PARTS], leak[PARTS];
        for (int side = 0; side < PARTS; ++side) {
            seen[side] = size[side];
            leak[side] = none;
        }
        march_parts(parts_of(b), law, window, degree, seen, leak);
        if (!misses(b, leak, seen, degree == NAME_DEGREE)) {
            for (int side = 0; side < PARTS; ++side) {
                missed[side] += leak[side];
                size[side] = seen[side];
            }
            return degree;
        }
        const int higher = degree + degree / 4;
        const int next = degree == NAME_DEGREE ? before : higher < NAME_DEGREE ? higher : NAME_DEGREE;
        for (int side = 0; side < PARTS; ++side) {
            raise_batch(parts_of(b) + side, degree, next);
        }
        tabulated(b, law, next);
        degree = next;
    }
}

/* What outputs are wrong by in the sets of a part, of which velocities are wrong by `missed`. */
static void weigh_batch(const part_of *p, const laws_batch *law, int degree, const wide *missed, wide *all)
{
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        wide weight = none;
        for (int k = 0; k < NAME_HEARD; ++k) {
            if (heard_output[k] == output) {
                weight += MAGNITUDES(law->gain[k]);
            }
        }
        all[output] = weight * *missed + read_by(degree) * p->largest[output];
    }
}

/* As estimated, of a set. */
static real estimated_of(const part_of *p, const wide *missed, const name_parameters *parameters, int lane)
{
    real worst = 0;
    laws law;
    laws_of(parameters, &law);
    (void)lane;
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        worst = larger(worst, relative(&law, &law, OF_VALUES, output, AT(missed[output], lane), AT(p->largest[output], lane)));
    }
    return worst;
}

/* All windows of a batch that has begun. */
static void marched_batch(batch_of *b, const laws_batch *law, const name_parameters *parameters)
{
    wide size[PARTS], missed[PARTS], heard[PARTS];
    size_t place = 0;
    int degree = LEAST, event = 0;
    for (int side = 0; side < PARTS; ++side) {
        size[side] = missed[side] = heard[side] = none;
    }
    tabulated(b, law, degree);
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        event = press_batch(b, window, event);
        degree = window_batch(b, law, window, degree, size, missed);
        b->degree[window] = degree;
        b->place[window] = place;
        listen_batch(parts_of(b), b->inverse, law, window, degree, (wide *)b->series[place], heard);
        look_batch(parts_of(b), (const wide *)b->series[place], window, degree);
        for (int side = 0; side < PARTS; ++side) {
            settle_batch(parts_of(b) + side);
        }
        place += (size_t)NAME_STRANDS * (size_t)(degree + 2);
    }
    for (int side = 0; side < PARTS; ++side) {
        const part_of *const p = parts_of(b) + side;
        wide wrong_there[NAME_OUTPUTS];
        missed[side] = 6 * missed[side] + rounded_by(degree) * size[side];
        weigh_batch(p, law + side, degree, missed + side, wrong_there);
        for (int lane = 0; lane < SETS; ++lane) {
            const int set = side * SETS + lane;
            if (b->status[set] == 0 && !(finite_number(AT(size[side], lane)) && finite_number(AT(missed[side], lane)) &&
                                         finite_number(AT(heard[side], lane)))) {
                b->status[set] = 1;
            }
            if (b->status[set] == 0) {
                b->estimate[set] = estimated_of(p, wrong_there, parameters + set, lane);
            }
        }
    }
}

int name_build_batch(name_batch *batch, const name_parameters *parameters, size_t sets)
{
    laws_batch law[PARTS];
    int highest = 0;
    for (int set = 0; set < NAME_WIDTH; ++set) {
        batch->estimate[set] = not_a_number();
    }
    if (begun_batch(batch, law, parameters, sets) > 0) {
        marched_batch(batch, law, parameters);
    }
    for (int set = 0; set < NAME_WIDTH && (size_t)set < sets; ++set) {
        highest = batch->status[set] > highest ? batch->status[set] : highest;
    }
    return highest;
}

int name_batch_model(const name_batch *batch, int set, name_model *model)
{
    model->built = set >= 0 && set < NAME_WIDTH && batch->status[set] == 0;
    model->estimate = model->built ? batch->estimate[set] : not_a_number();
    for (int window = 0; window < NAME_WINDOWS && model->built; ++window) {
        const size_t begin = batch->place[window];
        const size_t size = (size_t)NAME_STRANDS * (size_t)(batch->degree[window] + 2);
        model->degree[window] = batch->degree[window];
        model->place[window] = begin;
        for (size_t k = begin; k < begin + size; ++k) {
            model->series[k] = batch->series[k][set];
        }
    }
    return !model->built;
}
