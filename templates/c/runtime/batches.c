/* batches.c: models of many sets of parameters at once.
 * Plain C that stands below the text of a march in lanes in generated files, which have what stands below the first empty
 * line. */
#ifndef NAME_JOINTED
#include "batch.c"
#endif

/* Add to a strand a term that is summed up: the integral of its wave. */
static void listen_on(batch_of *b, int t, int window, int degree, const wide *gain, wide *c)
{
    wide *const total = &b->total[term_heard[t]];
    wide *const sum = b->work;
    wide low, high;
    integrate_batch(b, sent_batch(b, t, window), degree, half_length[term_panel[t]], sum);
    end_value_batch(sum, degree + 1, term_low[t], &low);
    end_value_batch(sum, degree + 1, term_high[t], &high);
    c[0] += *gain * (*total - low);
    *total += high - low;
    for (int k = 1; k <= degree + 1; ++k) {
        c[k] += *gain * sum[k];
    }
}

/* As listen, and as weigh: two waves at once, where they are not summed up. */
static void listen_batch(batch_of *b, const laws_batch *law, int window, int degree, wide *all, wide *heard)
{
    const size_t size = (size_t)(degree + 2);
    wide weight = none;
    for (int s = 0; s < NAME_STRANDS; ++s) {
        wide *const c = all + (size_t)s * size;
        const int last = first_term[s + 1];
        int t = first_term[s];
        wide here = none;
        c[degree + 1] = none;
        if (last - t == 2 && !term_summed[t] && !term_summed[t + 1]) {
            const wide *const w = sent_batch(b, t, window);
            const wide *const v = sent_batch(b, t + 1, window);
            const wide gain = law->gain[term_heard[t]], other_gain = law->gain[term_heard[t + 1]];
            for (int k = 0; k <= degree; ++k) {
                const wide sum = gain * w[k] + other_gain * v[k];
                c[k] = sum;
                here += MAGNITUDE(sum);
            }
        } else {
            for (int k = 0; k <= degree; ++k) {
                c[k] = none;
            }
            for (; t < last; ++t) {
                const wide *const w = sent_batch(b, t, window);
                const wide gain = law->gain[term_heard[t]];
                if (term_summed[t]) {
                    listen_on(b, t, window, degree, &gain, c);
                    continue;
                }
                for (int k = 0; k <= degree; ++k) {
                    c[k] += gain * w[k];
                }
            }
            for (int k = 0; k <= degree + 1; ++k) {
                here += MAGNITUDE(c[k]);
            }
        }
        weight += here;
    }
    *heard += (real)(4 * (degree + 2)) * weight;
}

/* As series_at. */
static void series_at_batch(const wide *c, int degree, real u, wide *value)
{
    wide next = none, after = none;
    for (int k = degree; k > 0; --k) {
        const wide now = (2 * u * next - after) + c[k];
        after = next;
        next = now;
    }
    *value = (u * next - after) + c[0];
}

/* The mean of an output on a section, and in which sets it makes it worth a look. */
static void mean_batch(const batch_of *b, const wide *all, size_t size, int at, wide *mean, mask *worth)
{
    wide sum = none;
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        sum += all[(size_t)strand_at[k] * size];
    }
    *mean = sum;
    *worth |= MAGNITUDE(sum) > b->worth[at % NAME_OUTPUTS];
}

/* As look; first whether there is anything to be looked at on a window. */
static void look_batch(batch_of *b, int window, int degree)
{
    const wide *const all = b->series + b->place[window];
    const size_t size = (size_t)(degree + 2);
    wide mean;
    mask some = NOWHERE;
    for (int at = 0; at < SECTIONS * NAME_OUTPUTS; ++at) {
        mean_batch(b, all, size, at, &mean, &some);
    }
    for (int at = 0; in_some(&some) && at < SECTIONS * NAME_OUTPUTS; ++at) {
        const int output = at % NAME_OUTPUTS;
        const int here = in_cycle(window, at / NAME_OUTPUTS);
        const real reach = NAME_TAU_MAX - cycle_begin(window);
        const real end = from[here + 1] < reach ? from[here + 1] : reach;
        const real middle = from[here] + (end - from[here]) / 2;
        mask worth = NOWHERE;
        wide sum = none;
        mean_batch(b, all, size, at, &mean, &worth);
        if (from[here] > end || !in_some(&worth)) {
            continue;
        }
        for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
            const int s = strand_at[k];
            const int now = window % CYCLE * NAME_STRANDS + s;
            wide found;
            series_at_batch(all + (size_t)s * size, degree + 1,
                            ((middle - strand_start[now]) + strand_excess[now]) * strand_scale[s] - 1, &found);
            sum += found;
        }
        enlarge_batch(&b->mean[output], &mean);
        enlarge_batch(&b->largest[output], &sum);
        const wide half_more = (real)1.5 * b->mean[output], much_more = 4 * b->largest[output];
        const mask less = half_more < much_more;
        b->worth[output] = CHOSEN(less, half_more, much_more);
    }
}

/* A set's laws, and how its loads change, into its lane. */
static void given_batch(batch_of *b, laws_batch *all, int set, const laws *law)
{
    spread(all, set, law);
    for (int event = 0; event < NAME_EVENTS; ++event) {
        LANE(b->change[event], set) =
            event_weight[event] * law->load[event_load[event]] * law->strength[event_strength[event]];
    }
}

/* What begins a batch: how many of its sets are good. */
static int begun_batch(batch_of *b, laws_batch *all, const name_parameters *parameters, size_t sets)
{
    laws law, other;
    int good_ones = 0;
    int good_one[NAME_WIDTH];
    for (int k = 0; k < NAME_HEARD; ++k) {
        b->total[k] = none;
    }
    for (int f = 0; f <= NAME_FORCES; ++f) {
        for (int power = 0; power < 3; ++power) {
            b->load[f][power] = none;
        }
        b->since[f][0] = 0;
        b->since[f][1] = 0;
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        b->largest[output] = none;
        b->mean[output] = none;
        b->worth[output] = none;
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
    if (good_ones > 0) {
        started_batch(b, all);
    }
    return good_ones;
}

/* Whether a set that is still good misses more than its share; at the highest degree it is refused. */
static int misses(batch_of *b, const wide *leak, const wide *size, int highest)
{
    int found = 0;
    for (int set = 0; set < NAME_WIDTH; ++set) {
        if (b->status[set] == 0 && !(LANE(*leak, set) <= share * LANE(*size, set))) {
            found = 1;
            if (highest) {
                b->status[set] = finite_number(LANE(*leak, set)) && finite_number(LANE(*size, set)) ? 2 : 1;
            }
        }
    }
    return found;
}

/* One window at the lowest degree that is enough; the degree. What a refused set would need is not asked of others. */
static int window_batch(batch_of *b, const laws_batch *law, int window, int degree, wide *size, wide *missed)
{
    const int before = degree;
    for (;;) {
        wide seen = *size, leak = none;
        march_batch(b, law, window, degree, &seen, &leak);
        if (!misses(b, &leak, &seen, degree == NAME_DEGREE)) {
            *missed += leak;
            *size = seen;
            return degree;
        }
        const int higher = degree + degree / 4;
        const int next = degree == NAME_DEGREE ? before : higher < NAME_DEGREE ? higher : NAME_DEGREE;
        raise_batch(b, law, degree, next);
        degree = next;
    }
}

/* As estimated, of a set. */
static real estimated_of(const batch_of *b, const wide *missed, const name_parameters *parameters, int set)
{
    real worst = 0;
    laws law;
    laws_of(parameters, &law);
    (void)set;
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        worst = larger(worst, relative(&law, &law, OF_VALUES, output, LANE(missed[output], set), LANE(b->largest[output], set)));
    }
    return worst;
}

int name_build_batch(name_batch *batch, const name_parameters *parameters, size_t sets)
{
    wide size = none, missed = none, heard = none;
    wide missed_there[NAME_OUTPUTS];
    laws_batch law;
    size_t place = 0;
    int degree = LEAST, event = 0, highest = 0;
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        missed_there[output] = none;
    }
    if (begun_batch(batch, &law, parameters, sets) > 0) {
        for (int window = 0; window < NAME_WINDOWS; ++window) {
            event = press_batch(batch, window, event);
            degree = window_batch(batch, &law, window, degree, &size, &missed);
            settle_batch(batch);
            batch->degree[window] = degree;
            batch->place[window] = place;
            listen_batch(batch, &law, window, degree, batch->series + place, &heard);
            look_batch(batch, window, degree);
            place += (size_t)NAME_STRANDS * (size_t)(degree + 2);
        }
        missed = 6 * missed + rounded_by(degree) * size;
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            wide weight = none;
            for (int k = 0; k < NAME_HEARD; ++k) {
                if (heard_output[k] == output) {
                    weight += MAGNITUDE(law.gain[k]);
                }
            }
            missed_there[output] = weight * missed + read_by(degree) * batch->largest[output];
        }
    }
    for (int set = 0; set < NAME_WIDTH; ++set) {
        if (batch->status[set] == 0 && !(finite_number(LANE(size, set)) && finite_number(LANE(missed, set)) &&
                                         finite_number(LANE(heard, set)))) {
            batch->status[set] = 1;
        }
        LANE(batch->estimate, set) =
            batch->status[set] == 0 ? estimated_of(batch, missed_there, parameters + set, set) : not_a_number();
        if ((size_t)set < sets && batch->status[set] > highest) {
            highest = batch->status[set];
        }
    }
    return highest;
}

int name_batch_model(const name_batch *batch, int set, name_model *model)
{
    model->built = set >= 0 && set < NAME_WIDTH && batch->status[set] == 0;
    model->estimate = model->built ? LANE(batch->estimate, set) : not_a_number();
    for (int window = 0; window < NAME_WINDOWS && model->built; ++window) {
        const size_t begin = batch->place[window];
        const size_t size = (size_t)NAME_STRANDS * (size_t)(batch->degree[window] + 2);
        model->degree[window] = batch->degree[window];
        model->place[window] = begin;
        for (size_t k = begin; k < begin + size; ++k) {
            model->series[k] = LANE(batch->series[k], set);
        }
    }
    return !model->built;
}
