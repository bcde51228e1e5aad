/* build.c: models, window by window: of one set of parameters, and of many in lanes. All sets have one degree, the highest
 * that one of them needs; one that is refused goes along, and what it would need is not asked of others. */
#include "outputs.c"

/* How far a build has come. `status` is what `build` returns; of all windows so far truncation errors, the largest velocity
 * or mean of a wave, and what outputs stay below; of the current one `leak` and `seen`. */
typedef struct {
    OF(march_state) *sets;
    OF(march_tables) *tables;
    const OF(laws) *law;
    real *inverse;
    int (*since)[2];
    num *series;
    int *degrees;
    size_t *places;
    int window, degree, event, status[OF(lanes_in_all)];
    size_t place;
    num missed[OF(parts)], size[OF(parts)], weight[OF(parts)], leak[OF(parts)], seen[OF(parts)];
} OF(progress);

/* Nothing gathered, no load; waves as they are at first, as series of so many numbers, and states. */
static void OF(start_set)(OF(march_state) *m, const OF(laws) *law, int count)
{
    OF(clear)(m->total, NAME_GAINS);
    OF(clear)((num *)m->load, (int)(sizeof m->load / sizeof(num)));
    OF(clear)((num *)m->force, (int)(sizeof m->force / sizeof(num)));
    OF(clear)((num *)&m->extremes, (int)(sizeof m->extremes / sizeof(num)));
    for (int track = 0; track < NAME_TRACKS; ++track) {
        for (int place = ring[track]; place <= ring[track] + steps[track]; ++place) {
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                OF(clear)(m->waves[place][panel], count);
                m->waves[place][panel][0] = law->initial_wave[track];
            }
        }
    }
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = law->initial[k];
    }
}

/* Tables for a degree; 1 / (2 k). */
static BY_ITSELF void OF(tabulate_degree)(OF(progress) *b, int degree)
{
    b->degree = degree;
    for (int k = 1; k <= degree + SPARE; ++k) {
        b->inverse[k] = 1 / (real)(2 * k);
    }
    OF(tabulate)(b->tables, b->law, OF(parts), degree);
}

/* The start of a build, for which memory and laws are known. */
static void OF(start)(OF(progress) *b)
{
    b->window = b->event = 0;
    b->place = 0;
    for (int f = 0; f <= NAME_FORCES; ++f) {
        b->since[f][0] = b->since[f][1] = 0;
    }
    for (int side = 0; side < OF(parts); ++side) {
        b->missed[side] = b->size[side] = b->weight[side] = b->leak[side] = b->seen[side] = ZERO;
        OF(start_set)(b->sets + side, b->law + side, LEAST + SPARE);
    }
    OF(tabulate_degree)(b, LEAST);
}

/* A load, as powers of the time since it changed, takes an event. */
static void OF(change_load)(num *c, const num *change, int event, real time)
{
    c[0] += time * (c[1] + time * c[2]);
    c[1] += 2 * time * c[2];
    for (int k = 0; k < 3 && event_power[event] >= 3; ++k) {
        c[k] = ZERO; /* it starts again */
    }
    c[event_power[event] % 3] += *change;
}

/* The loads of some sets on the panels of a window, as series, after their changes there, the first of which is `event`. The
 * first one of the next window. */
static BY_ITSELF int OF(apply_loads)(OF(march_state) *all, int sets, int (*since)[2], int window, int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        const real half = half_length[panel];
        for (; is_event(event, window, panel); ++event) {
            int *const then = since[event_force[event]];
            for (int set = 0; set < sets; ++set) {
                OF(march_state) *const m = all + set;
                OF(change_load)(m->load[event_force[event]], &m->change[event], event, time_since(then, window, panel));
            }
            then[0] = window;
            then[1] = panel;
        }
        for (int f = 0; f < NAME_FORCES; ++f) {
            const real middle = time_since(since[f], window, panel) + half;
            for (int set = 0; set < sets; ++set) {
                OF(load_series)(all[set].load[f], middle, half, all[set].force[panel][f]);
            }
        }
    }
    return event;
}

/* Series of a set become longer: what they had not is 0. */
static void OF(lengthen)(OF(march_state) *m, int degree, int higher)
{
    for (int place = 0; place < NAME_SLOTS; ++place) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            OF(clear)(m->waves[place][panel] + degree + 1, higher - degree + SPARE - 1);
        }
    }
}

/* The current window at the current degree. */
static void OF(march_window)(OF(progress) *b)
{
    for (int side = 0; side < OF(parts); ++side) {
        b->seen[side] = b->size[side];
        b->leak[side] = ZERO;
    }
    OF(march)(b->sets, b->tables, b->law, OF(parts), b->window, b->degree, NULL, b->seen, b->leak);
}

/* The same at another degree. */
static void OF(march_again)(OF(progress) *b, int degree)
{
    for (int side = 0; side < OF(parts) && degree > b->degree; ++side) {
        OF(lengthen)(b->sets + side, b->degree, degree);
    }
    OF(tabulate_degree)(b, degree);
    OF(march_window)(b);
}

/* Whether some set that is not refused misses more than its share; at the highest degree it is refused. */
static BY_ITSELF int OF(misses)(OF(progress) *b)
{
    int found = 0, some = 0;
    for (int side = 0; side < OF(parts); ++side) {
        const TEST late = (b->leak[side] <= share * b->seen[side]) == 0;
        some |= SOME(late);
    }
    for (int set = 0; some && set < OF(lanes_in_all); ++set) {
        const real missed = LANE(b->leak, set), seen = LANE(b->seen, set);
        if (b->status[set] == 0 && !(missed <= share * seen)) {
            found = 1;
            if (b->degree == NAME_DEGREE) {
                b->status[set] = finite_number(missed) && finite_number(seen) ? 2 : 1;
            }
        }
    }
    return found;
}

/* The next window, at the lowest degree, raised by quarters, that is enough. Whether it is for some set. */
static int OF(next_window)(OF(progress) *b)
{
    const int before = b->degree;
    int left = 0;
    b->event = OF(apply_loads)(b->sets, OF(parts), b->since, b->window, b->event);
    OF(march_window)(b);
    while (OF(misses)(b)) {
        const int next = b->degree == NAME_DEGREE ? before : higher_than(b->degree);
        OF(march_again)(b, next);
    }
    for (int set = 0; set < OF(lanes_in_all); ++set) {
        left |= b->status[set] == 0;
    }
    return left;
}

/* A window that has been marched is good: its outputs; then the next one is due. */
static void OF(keep_window)(OF(progress) *b)
{
    num *const all = b->series + b->place * OF(parts);
    b->degrees[b->window] = b->degree;
    b->places[b->window] = b->place;
    OF(accumulate)(b->sets, b->inverse, b->law, b->window, b->degree, 0, all, b->weight);
    for (int side = 0; side < OF(parts); ++side) {
        OF(march_state) *const m = b->sets + side;
        OF(find_largest)(&m->extremes, all + side, b->window, b->degree);
        b->missed[side] += b->leak[side];
        b->size[side] = b->seen[side];
        for (int k = 0; k < NAME_STATES; ++k) {
            m->state[0][k] = m->state[1][k];
        }
    }
    b->place += (size_t)NAME_STRANDS * (size_t)(b->degree + 2);
    b->window += 1;
}

/* How an output weighs waves, added up. */
static BY_ITSELF void OF(weight_of)(const OF(laws) *law, int output, num *weight)
{
    *weight = ZERO + faint; /* gains may underflow */
    for (int k = 0; k < NAME_GAINS; ++k) {
        *weight += gain_output[k] == output ? SIZE_OF(law->gain[k]) : ZERO;
    }
}

/* The estimates after the last window; what overflows is refused. */
static void OF(finish)(OF(progress) *b, const name_parameters *parameters, real *estimate)
{
    for (int set = 0; set < OF(lanes_in_all); ++set) {
        const int finite = finite_number(LANE(b->size, set)) && finite_number(LANE(b->weight, set)) &&
                           finite_number(velocity_error(LANE(b->missed, set), LANE(b->size, set), b->degree));
        b->status[set] = b->status[set] == 0 && !finite ? 1 : b->status[set];
        estimate[set] = b->status[set] == 0 ? 0 : not_a_number();
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        num error[OF(parts)], largest[OF(parts)];
        for (int side = 0; side < OF(parts); ++side) {
            largest[side] = b->sets[side].extremes.largest[output];
            OF(weight_of)(b->law + side, output, &error[side]);
        }
        for (int set = 0; set < OF(lanes_in_all); ++set) {
            if (b->status[set] == 0) {
                const real own = LANE(largest, set);
                const real missed = velocity_error(LANE(b->missed, set), LANE(b->size, set), b->degree);
                const real wrong = LANE(error, set) * missed + read_by(b->degree) * own;
                estimate[set] = larger(estimate[set], relative(parameters + set, output, wrong, own));
            }
        }
    }
}

/* All windows of a build that has started, as long as some set is good. */
static void OF(march_all)(OF(progress) *b)
{
    while (b->window < NAME_WINDOWS && OF(next_window)(b)) {
        OF(keep_window)(b);
    }
}

#undef num
#undef OF
#undef PICK
#undef SIZE_OF
#undef SIZES_OF
#undef TOTAL_OF
#undef ZERO
#undef NOTHING
#undef TEST
#undef SOME
#undef LANE
