/* runtime_batch.c: the march of runtime.c for many sets of parameters at once, a set in each lane of a vector.
 * Plain C where there is no GNU C, one set at a time. Stands below the text of runtime.c in generated files, which have
 * what stands below the first empty line. */
#include "runtime_bound.c"

/* All sets have one degree, the highest that one of them needs. A set that is refused goes along as another, or runs
 * wild in its own lane. */
typedef name_batch batch_of;
typedef name_wide wide;

#if defined(NAME_VECTORS)
static const wide none = {0};
typedef __typeof__(none < none) mask;
#define LANE(x, set) ((x)[set])
#define CHOSEN(test, one, other) ((wide)(((test) & (mask)(one)) | (~(test) & (mask)(other))))
#else
static const wide none = 0;
typedef int mask;
#define LANE(x, set) (x)
#define CHOSEN(test, one, other) ((test) ? (one) : (other))
#endif

/* `most` grows to the magnitude of x */
static void enlarge(wide *most, const wide *x)
{
    const mask below = *x < none;
    const wide size = CHOSEN(below, -*x, *x);
    const mask more = size > *most;
    *most = CHOSEN(more, size, *most);
}

static void add_magnitude(wide *sum, const wide *x)
{
    const mask below = *x < none;
    *sum += CHOSEN(below, -*x, *x);
}

/* As tabulate: nodes whose laws are alike share a table. */
static void tabulate_batch(batch_of *b, int degree)
{
    for (int k = 1; k <= degree + 1; ++k) {
        b->inverse[k] = 1 / (real)(2 * k);
    }
    for (int here = 0; here < NAME_PANELS * NAME_NODES; ++here) {
        const wide step = b->rate[here % NAME_NODES] * (2 * half_length[here / NAME_NODES]);
        wide *const ratio = b->table[here][RATIO];
        wide *const first = b->table[here][FIRST];
        wide *const last = b->table[here][LAST];
        if (alike[here] != here || !is_body[here % NAME_NODES]) {
            continue;
        }
        ratio[degree + 1] = none;
        first[degree + 1] = none;
        last[degree + 1] = none;
        for (int k = degree; k > 0; --k) {
            ratio[k] = step / ((real)(4 * k) + step * ratio[k + 1]);
            first[k] = (real)(k % 2 ? -1 : 1) - ratio[k + 1] * first[k + 1];
            last[k] = 1 - ratio[k + 1] * last[k + 1];
        }
        const wide begun = 2 * ratio[1] * first[1];
        b->edge[here][SLACK] = -begun / (1 - begun);
        b->edge[here][LOSS] = 2 * ratio[1] * last[1];
        b->edge[here][LEAK] = step / (real)(4 * (degree + 1));
    }
}

/* As press. */
static int press_batch(batch_of *b, int window, int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        while (event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel) {
            const int f = event_force[event];
            wide *const c = b->load[f];
            const real gone = (real)(window - b->since[f][0]) + since_panel[panel * NAME_PANELS + b->since[f][1]];
            c[0] += gone * (c[1] + gone * c[2]);
            c[1] += 2 * gone * c[2];
            for (int k = 0; k < 3 && event_power[event] >= 3; ++k) {
                c[k] = none;
            }
            c[event_power[event] % 3] += b->change[event];
            b->since[f][0] = window;
            b->since[f][1] = panel;
            ++event;
        }
        const real half = half_length[panel];
        for (int f = 0; f < NAME_FORCES; ++f) {
            const wide *const c = b->load[f];
            const real gone = (real)(window - b->since[f][0]) + since_panel[panel * NAME_PANELS + b->since[f][1]];
            const real middle = gone + half;
            b->force[panel][f][0] = (c[0] + middle * c[1]) + (middle * middle + half * half / 2) * c[2];
            b->force[panel][f][1] = half * (c[1] + 2 * middle * c[2]);
            b->force[panel][f][2] = half * half / 2 * c[2];
        }
    }
    return event;
}

/* As march does it at a node without inertia. */
static void passed(const wide *alpha, const wide *a, const wide *beta, const wide *c, const wide *force, int degree,
                   wide *left, wide *right)
{
    for (int k = 0; k <= degree; ++k) {
        const wide p = *alpha * a[k] + *beta * c[k];
        const wide sent = force && k < 3 ? p + force[k] : p;
        left[k] = sent - a[k];
        right[k] = sent - c[k];
    }
}

/* As moved and march at a body, both at once; what the polynomial misses is added. */
static void moved_batch(batch_of *b, int row, const wide *alpha, const wide *a, const wide *beta, const wide *c,
                        const wide *force, int degree, wide *velocity, wide *missed, wide *left, wide *right)
{
    const wide *const ratio = b->table[row][RATIO];
    const wide *const first = b->table[row][FIRST];
    const wide *const last = b->table[row][LAST];
    wide *const q = b->work;
    const wide highest = *alpha * a[degree] + *beta * c[degree];
    wide above = none, here = highest, y = none, begun = none, ended = none;
    for (int k = degree; k > 0; --k) {
        wide below = *alpha * a[k - 1] + *beta * c[k - 1];
        if (force && k <= 3) {
            below += force[k - 1];
        }
        y = ratio[k] * (((k == 1 ? 2 * below : below) - above) + y);
        q[k] = y;
        begun += first[k] * y;
        ended += last[k] * y;
        above = here;
        here = below;
    }
    begun = *velocity - begun;
    const wide mean = begun - b->edge[row][SLACK] * begun;
    *velocity = mean + (ended - b->edge[row][LOSS] * mean);
    left[0] = mean - a[0];
    right[0] = mean - c[0];
    wide before = 2 * mean;
    for (int k = 1; k <= degree; ++k) {
        before = q[k] - ratio[k] * before;
        left[k] = before - a[k];
        right[k] = before - c[k];
    }
    const wide excess = b->edge[row][LEAK] * (before - highest);
    add_magnitude(missed, &excess);
}

/* As march. */
static void march_batch(batch_of *b, int half, int degree, wide *size, wide *missed)
{
    for (int node = 0; node < NAME_NODES; ++node) {
        b->velocity[1][node] = b->velocity[0][node];
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        for (int f = 0; f < NAME_FORCES; ++f) {
            for (int k = 0; k < 3; ++k) {
                b->waves[half][LOAD][panel][f][k] = b->force[panel][f][k];
            }
        }
        for (int node = 0; node < NAME_NODES; ++node) {
            const wide *const a = b->waves[!half][RIGHT][panel][node];
            const wide *const c = b->waves[!half][LEFT][panel][node + 2];
            const wide *const force = force_on[node] < 0 ? NULL : b->force[panel][force_on[node]];
            wide *const left = b->waves[half][LEFT][panel][node + 1];
            wide *const right = b->waves[half][RIGHT][panel][node + 1];
            if (is_body[node]) {
                const int row = alike[panel * NAME_NODES + node];
                moved_batch(b, row, &b->alpha[node], a, &b->beta[node], c, force, degree, &b->velocity[1][node], missed,
                            left, right);
                enlarge(size, &b->velocity[1][node]);
            } else {
                passed(&b->alpha[node], a, &b->beta[node], c, force, degree, left, right);
            }
            enlarge(size, left);
            enlarge(size, right);
        }
    }
}

/* As integrate, and times half the length of the panel. */
static void integrate_batch(const batch_of *b, const wide *w, int degree, real half, wide *c)
{
    c[0] = none;
    c[1] = half * (degree > 1 ? w[0] - w[2] / 2 : w[0]);
    for (int k = 2; k < degree; ++k) {
        c[k] = (w[k - 1] - w[k + 1]) * (half * b->inverse[k]);
    }
    c[degree] = w[degree - 1] * (half * b->inverse[degree]);
    c[degree + 1] = w[degree] * (half * b->inverse[degree + 1]);
}

/* As end_value. */
static void end_value_batch(const wide *c, int degree, real u, wide *value)
{
    wide next = none, after = none;
    if (u > -1 && u < 1 && (u < 0 || u > 0)) {
        for (int k = degree; k > 0; --k) {
            const wide now = (2 * u * next - after) + c[k];
            after = next;
            next = now;
        }
        *value = (u * next - after) + c[0];
        return;
    }
    const int by = u < 0 || u > 0 ? 1 : 2;
    for (int k = 0; k <= degree; k += 2 * by) {
        next += c[k];
        after += k + by <= degree ? c[k + by] : none;
    }
    *value = u > 0 ? next + after : next - after;
}

/* The wave of a term, or its integral in `work`; up to which degree it goes. */
static const wide *term_batch(batch_of *b, int t, int half, int degree, wide *mean, int *highest)
{
    const wide *const w = b->waves[term_back[t] ? !half : half][term_way[t]][term_panel[t]][term_sender[t]];
    *highest = degree;
    *mean = w[0];
    if (term_summed[t]) {
        wide *const total = &b->total[term_heard[t]];
        wide low, high;
        integrate_batch(b, w, degree, half_length[term_panel[t]], b->work);
        end_value_batch(b->work, degree + 1, term_low[t], &low);
        end_value_batch(b->work, degree + 1, term_high[t], &high);
        *mean = *total - low;
        *total += high - low;
        *highest = degree + 1;
        return b->work;
    }
    return w;
}

/* As listen and look: two waves at once, where they are not summed up. */
static void listen_batch(batch_of *b, int half, int degree, wide *all)
{
    const size_t size = (size_t)(degree + 2);
    for (int s = 0; s < NAME_STRANDS; ++s) {
        wide *const c = all + (size_t)s * size;
        int t = first_term[s];
        if (first_term[s + 1] - t >= 2 && !term_summed[t] && !term_summed[t + 1]) {
            wide mean, other_mean;
            int highest;
            const wide *const w = term_batch(b, t, half, degree, &mean, &highest);
            const wide *const v = term_batch(b, t + 1, half, degree, &other_mean, &highest);
            const wide gain = b->gain[term_heard[t]], other_gain = b->gain[term_heard[t + 1]];
            for (int k = 0; k <= degree; ++k) {
                c[k] = gain * w[k] + other_gain * v[k];
            }
            c[degree + 1] = none;
            t += 2;
        } else {
            for (int k = 0; k <= degree + 1; ++k) {
                c[k] = none;
            }
        }
        for (; t < first_term[s + 1]; ++t) {
            wide mean;
            int highest;
            const wide *const w = term_batch(b, t, half, degree, &mean, &highest);
            const wide gain = b->gain[term_heard[t]];
            c[0] += gain * mean;
            for (int k = 1; k <= highest; ++k) {
                c[k] += gain * w[k];
            }
        }
    }
    for (int at = 0; at < SECTIONS * NAME_OUTPUTS; ++at) {
        wide mean = none;
        for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
            mean += all[(size_t)strand_at[k] * size];
        }
        enlarge(&b->largest[at % NAME_OUTPUTS], &mean);
    }
}

/* A set's laws into its lane; what they are in other lanes stays. */
static void spread(batch_of *b, int set, const laws *law)
{
    (void)set;
    for (int node = 0; node < NAME_NODES; ++node) {
        LANE(b->alpha[node], set) = law->alpha[node];
        LANE(b->beta[node], set) = law->beta[node];
        LANE(b->rate[node], set) = law->rate[node];
        LANE(b->velocity[0][node], set) = law->motion[node];
    }
    for (int k = 0; k < NAME_HEARD; ++k) {
        LANE(b->gain[k], set) = law->gain[k];
    }
    for (int event = 0; event < NAME_EVENTS; ++event) {
        LANE(b->change[event], set) = event_weight[event] * law->load[event_load[event]] * law->strength[event_strength[event]];
    }
    for (int half = 0; half < 2; ++half) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            for (int node = 0; node <= NAME_NODES; ++node) {
                LANE(b->waves[half][LEFT][panel][node + 1][0], set) = law->rod[node];
                LANE(b->waves[half][RIGHT][panel][node][0], set) = law->rod[node];
            }
        }
    }
}

/* At rest, and nothing gathered. */
static void still(batch_of *b)
{
    for (int half = 0; half < 2; ++half) {
        for (int way = LEFT; way <= LOAD; ++way) {
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                for (int node = 0; node < NAME_NODES + 2; ++node) {
                    for (int k = 0; k <= LEAST; ++k) {
                        b->waves[half][way][panel][node][k] = none;
                    }
                }
            }
        }
    }
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
    }
}

/* What begins a batch: how many of its sets are good. */
static int begun_batch(batch_of *b, const name_parameters *parameters, size_t sets)
{
    laws law, other;
    int good_ones = 0;
    int good_one[NAME_WIDTH];
    still(b);
    for (int set = 0; set < NAME_WIDTH; ++set) {
        good_one[set] = 0;
        b->status[set] = 1;
        if ((size_t)set < sets && good(parameters + set)) {
            laws_of(parameters + set, &law);
            good_one[set] = laws_to_march(&law);
        }
        if (good_one[set]) {
            b->status[set] = 0;
            spread(b, set, &law);
            other = law;
            ++good_ones;
        }
    }
    for (int set = 0; good_ones > 0 && set < NAME_WIDTH; ++set) {
        if (!good_one[set]) {
            spread(b, set, &other);
        }
    }
    return good_ones;
}

/* As lengthen. */
static void lengthen_batch(batch_of *b, int degree, int higher)
{
    for (int half = 0; half < 2; ++half) {
        for (int way = LEFT; way <= LOAD; ++way) {
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                for (int node = 0; node < NAME_NODES + 2; ++node) {
                    for (int k = degree + 1; k <= higher; ++k) {
                        b->waves[half][way][panel][node][k] = none;
                    }
                }
            }
        }
    }
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
static int window_batch(batch_of *b, int window, int degree, wide *size, wide *missed)
{
    const int before = degree;
    for (;;) {
        wide seen = *size, leak = none;
        march_batch(b, window % 2, degree, &seen, &leak);
        if (!misses(b, &leak, &seen, degree == NAME_DEGREE)) {
            *missed += leak;
            *size = seen;
            return degree;
        }
        const int higher = degree + degree / 4;
        const int next = degree == NAME_DEGREE ? before : higher < NAME_DEGREE ? higher : NAME_DEGREE;
        lengthen_batch(b, degree, next);
        tabulate_batch(b, next);
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
        worst = larger(worst, relative(&law, output, LANE(missed[output], set), LANE(b->largest[output], set)));
    }
    return worst;
}

int name_build_batch(name_batch *batch, const name_parameters *parameters, size_t sets)
{
    wide size = none, missed = none, heard = none;
    wide missed_there[NAME_OUTPUTS];
    size_t place = 0;
    int degree = LEAST, event = 0, highest = 0;
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        missed_there[output] = none;
    }
    if (begun_batch(batch, parameters, sets) > 0) {
        tabulate_batch(batch, degree);
        for (int window = 0; window < NAME_WINDOWS; ++window) {
            event = press_batch(batch, window, event);
            degree = window_batch(batch, window, degree, &size, &missed);
            for (int node = 0; node < NAME_NODES; ++node) {
                batch->velocity[0][node] = batch->velocity[1][node];
            }
            batch->degree[window] = degree;
            batch->place[window] = place;
            listen_batch(batch, window % 2, degree, batch->series + place);
            for (const size_t end = place + (size_t)NAME_STRANDS * (size_t)(degree + 2); place < end; ++place) {
                const wide most = (real)(4 * (degree + 2)) * batch->series[place];
                add_magnitude(&heard, &most);
            }
        }
        missed = 6 * missed + rounded_by(degree) * size;
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            wide weight = none;
            for (int k = 0; k < NAME_HEARD; ++k) {
                if (heard_output[k] == output) {
                    add_magnitude(&weight, &batch->gain[k]);
                }
            }
            missed_there[output] = weight * missed;
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
