/* runtime_bound.c: a proved bound of the errors of a model, from what it sends itself.
 * Plain C that stands below the text of runtime.c in generated files, which have what stands below the first empty line. */
#include "runtime_read.c"

/* What may be wrong, at most; docs/march.md of wavesym has the proof. In short: let q be what a body sends plus what
 * arrived. How far q is from the law of the body is computed here, rounding included. That starts an error on this panel;
 * the energy of errors, the norm in which masses and waves are squared, never grows afterwards. */
typedef struct {
    real energy;                              /* the norm of all errors so far */
    real wave[2][2][NAME_NODES + 2];          /* the largest error of a wave on a window, of both halves */
    real size[2][2][NAME_PANELS][NAME_NODES + 2]; /* of a wave the sum of its coefficients' magnitudes */
    real most[2][2][NAME_NODES + 2][2];       /* on a window the largest, and that of sums with weights */
    real weight[NAME_ROW];                    /* (k + 1)(k + 2) */
    real force[NAME_PANELS][NAME_FORCES + 1]; /* of a load, on this window */
    real total[NAME_HEARD + 1];               /* of an integral */
    real end[NAME_NODES], end_error[NAME_NODES];
    real mass[NAME_NODES];                    /* root of half the mass of a body */
    real sent[NAME_PANELS][NAME_NODES];       /* the energy of waves of size 1 on a panel, to both sides */
    real moved[NAME_PANELS][NAME_NODES];      /* and that of a velocity as large, with its waves */
    real load[NAME_FORCES + 1][3], roundings[NAME_FORCES + 1];
    int since[NAME_FORCES + 1][2];
    int way[NAME_HEARD + 1], sender[NAME_HEARD + 1], summed[NAME_HEARD + 1]; /* which wave is heard */
    real output[NAME_OUTPUTS], largest[NAME_OUTPUTS];
    int window[NAME_OUTPUTS];                 /* where an output is large */
} wrong;

/* No less than the root, and hardly more: half the sum of y and x/y is no less, whatever y is. */
static real root(real x)
{
    real y = 1;
    if (!(x > 0) || !finite_number(x)) {
        return x > 0 ? infinity() : 0;
    }
    while (y * y < x) {
        y *= 2;
    }
    while (y * y / 4 > x) {
        y /= 2;
    }
    for (int k = 0; k < 3; ++k) {
        y = (y + x / y) / 2;
    }
    return y * (1 + 4 * unit);
}

/* Nothing is wrong but what laws are rounded by. Impedances follow from rod to rod, as alpha to beta. */
static void begun_wrong(wrong *w, const laws *law)
{
    real impedance = 1;
    w->energy = 0;
    const real rounded = roundings * unit;
    for (int half = 0; half < 2; ++half) {
        for (int node = 0; node < NAME_NODES + 2; ++node) {
            w->wave[half][LEFT][node] = node > 0 ? rounded * magnitude(law->rod[node - 1]) : 0;
            w->wave[half][RIGHT][node] = node <= NAME_NODES ? rounded * magnitude(law->rod[node]) : 0;
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                w->size[half][LEFT][panel][node] = node > 0 ? magnitude(law->rod[node - 1]) : 0;
                w->size[half][RIGHT][panel][node] = node <= NAME_NODES ? magnitude(law->rod[node]) : 0;
            }
            for (int way = LEFT; way <= RIGHT; ++way) {
                w->most[half][way][node][0] = w->size[half][way][0][node];
                w->most[half][way][node][1] = 2 * w->size[half][way][0][node];
            }
        }
    }
    for (int node = 0; node < NAME_NODES; ++node) {
        const real alpha = law->alpha[node];
        const real beta = law->beta[node];
        const real before = impedance;
        impedance = alpha > 0 && beta > 0 ? impedance * (beta / alpha) : impedance;
        const real mass = beta > 0 ? impedance / beta : before / alpha;
        const real both = root(before + impedance);
        w->mass[node] = is_body[node] ? root(mass / law->rate[node]) : 0;
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            const real length = 2 * half_length[panel];
            w->sent[panel][node] = root(length) * both;
            w->moved[panel][node] =
                is_body[node] ? root(1 + 2 * law->rate[node] * length) * w->mass[node] : w->sent[panel][node];
        }
        w->end[node] = law->motion[node];
        w->end_error[node] = rounded * magnitude(law->motion[node]);
        w->energy += rounded * both * (magnitude(law->rod[node]) + magnitude(law->rod[node + 1]));
    }
    for (int k = 0; k <= NAME_HEARD; ++k) {
        w->total[k] = 0;
    }
    for (int f = 0; f <= NAME_FORCES; ++f) {
        w->load[f][0] = w->load[f][1] = w->load[f][2] = 0;
        w->roundings[f] = roundings + 8;
        w->since[f][0] = w->since[f][1] = 0;
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            w->force[panel][f] = 0;
        }
    }
    for (int t = 0; t < first_term[NAME_STRANDS]; ++t) {
        w->way[term_heard[t]] = term_way[t];
        w->sender[term_heard[t]] = term_sender[t];
        w->summed[term_heard[t]] = term_summed[t];
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        w->output[output] = 0;
        w->largest[output] = 0;
        w->window[output] = 0;
    }
    for (int k = 0; k < NAME_ROW; ++k) {
        w->weight[k] = ((real)k + 1) * ((real)k + 2);
    }
}

/* Of a wave on a panel the sums of its coefficients' magnitudes, as they are and with weights. */
static void weighed(wrong *w, int half, int way, int panel, int node, real size, real weight)
{
    real *const most = w->most[half][way][node];
    w->size[half][way][panel][node] = size;
    most[0] = panel > 0 && most[0] > size ? most[0] : size;
    most[1] = panel > 0 && most[1] > weight ? most[1] : weight;
}

/* The time since a load changed. */
static real gone_by(const wrong *w, int window, int panel, int f)
{
    return (real)(window - w->since[f][0]) + since_panel[panel * NAME_PANELS + w->since[f][1]];
}

/* As press, with the absolute values of all that is added. */
static int pressed(wrong *w, const real *change, int window, int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        while (event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel) {
            const int f = event_force[event];
            real *const c = w->load[f];
            const real gone = gone_by(w, window, panel, f);
            c[0] += gone * (c[1] + gone * c[2]);
            c[1] += 2 * gone * c[2];
            for (int k = 0; k < 3 && event_power[event] >= 3; ++k) {
                c[k] = 0;
                w->roundings[f] = roundings + 8;
            }
            c[event_power[event] % 3] += magnitude(change[event]);
            w->since[f][0] = window;
            w->since[f][1] = panel;
            w->roundings[f] += 8;
            ++event;
        }
        for (int f = 0; f < NAME_FORCES; ++f) {
            const real *const c = w->load[f];
            const real gone = gone_by(w, window, panel, f) + 2 * half_length[panel];
            w->force[panel][f] = (w->roundings[f] + 12) * unit * (c[0] + 2 * gone * (c[1] + 2 * gone * c[2]));
        }
    }
    return event;
}

static const real alternating[17] = {1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1};

/* What a node adds to the errors on a panel: to those of its velocity, and more to the wave to the right. */
static void defect(const model_of *m, const laws *law, wrong *w, int half, int panel, int node, int degree,
                   real *velocity, real *more)
{
    const real *const a = m->waves[!half][RIGHT][panel][node];
    const real *const b = m->waves[!half][LEFT][panel][node + 2];
    const real *const left = m->waves[half][LEFT][panel][node + 1];
    const real *const right = m->waves[half][RIGHT][panel][node + 1];
    const real alpha = law->alpha[node];
    const real beta = law->beta[node];
    const int f = force_on[node];
    const real spare = (real)(16 * (degree + 4)) * least_number;
    real apart[NAME_ROW + LANES + 1]; /* q - p */
    real q[NAME_ROW + LANES + 1];
    real load[3 + LANES] = {0};
    slice rounded = nothing, lefts = nothing, rights = nothing, sents = nothing, aparts = nothing, unequal = nothing;
    slice begins = nothing, ends = nothing, weigh_left = nothing, weigh_right = nothing;
    for (int k = 0; f >= 0 && k < 3; ++k) {
        load[k] = m->force[panel][f][k];
    }
    size_t end = 0;
    for (; end <= (size_t)degree; end += LANES) {
        const slice from_left = alpha * *slice_at(a, end);
        const slice from_right = beta * *slice_at(b, end);
        slice p = from_left + from_right;
        slice pushed = MAGNITUDE(from_left) + MAGNITUDE(from_right);
        if (end < 3) {
            const slice of_load = *slice_at(load, end);
            p += of_load;
            pushed += MAGNITUDE(of_load);
        }
        const slice to_left = *slice_at(left, end);
        const slice to_right = *slice_at(right, end);
        const slice sent = to_left + *slice_at(a, end);
        const slice much = sent - p;
        const slice more_right = (to_right - to_left) - (*slice_at(a, end) - *slice_at(b, end));
        *(slice *)(q + end) = sent;
        *(slice *)(apart + end) = much;
        lefts += MAGNITUDE(to_left);
        rights += MAGNITUDE(to_right);
        weigh_left += *slice_at(w->weight, end) * MAGNITUDE(to_left);
        weigh_right += *slice_at(w->weight, end) * MAGNITUDE(to_right);
        sents += MAGNITUDE(sent);
        aparts += MAGNITUDE(much);
        rounded += (roundings + 4) * pushed + (roundings + 8) * MAGNITUDE(much);
        unequal += MAGNITUDE(more_right);
        begins += *slice_at(alternating, end % 2) * sent;
        ends += sent;
    }
    const real before = w->size[!half][RIGHT][panel][node];
    const real here = total_of(&lefts);
    const real there = total_of(&rights);
    const real size = total_of(&sents);
    weighed(w, half, LEFT, panel, node + 1, here, total_of(&weigh_left));
    weighed(w, half, RIGHT, panel, node + 1, there, total_of(&weigh_right));
    *more = total_of(&unequal) + unit * (here + there + before + w->size[!half][LEFT][panel][node + 2]);
    const real pushed_wrong = unit * (2 * (here + before) + total_of(&rounded)) +
                              (f >= 0 ? w->force[panel][f] : (real)0) + spare;
    if (!is_body[node]) {
        *velocity = total_of(&aparts) + pushed_wrong;
        return;
    }
    const real step = law->rate[node] * half_length[panel];
    slice missed = nothing;
    apart[0] *= 2;
    for (size_t k = 0; k <= LANES; ++k) {
        apart[end + k] = 0;
        q[end + k] = 0;
    }
    for (size_t k = 1; k <= (size_t)degree + 1; k += LANES) {
        const slice bent = step * *slice_at(m->inverse, k) * (*slice_at(apart, k - 1) - *slice_at(apart, k + 1));
        const slice rest = *slice_at(q, k) + bent;
        missed += MAGNITUDE(rest) + 3 * unit * MAGNITUDE(bent);
    }
    const real begun = total_of(&begins);
    const real ended = total_of(&ends);
    const real summing = unit * ((real)(degree / LANES) / 2 + 4) * size + spare;
    const real jump = magnitude(begun - w->end[node]) + unit * (size + magnitude(w->end[node]));
    const real wrong_law = total_of(&missed) + unit * size + spare;
    *velocity = 2 * wrong_law + (jump + summing + w->end_error[node]) + pushed_wrong;
    w->end[node] = ended;
    w->end_error[node] = summing + unit * size;
}

/* What a window adds to the errors, and how large those of its waves are. */
static void worsen(const model_of *m, const laws *law, wrong *w, int half, int degree)
{
    real own[NAME_NODES], more[NAME_NODES];
    for (int node = 0; node < NAME_NODES; ++node) {
        own[node] = 0;
        more[node] = 0;
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            real velocity, unequal;
            defect(m, law, w, half, panel, node, degree, &velocity, &unequal);
            w->energy += w->moved[panel][node] * velocity + w->sent[panel][node] * unequal;
            own[node] = velocity > own[node] ? velocity : own[node];
            more[node] = unequal > more[node] ? unequal : more[node];
        }
    }
    for (int node = 0; node < NAME_NODES; ++node) {
        const real a = w->wave[!half][RIGHT][node];
        const real b = w->wave[!half][LEFT][node + 2];
        real left, right;
        if (is_body[node]) {
            const real velocity = w->energy / w->mass[node];
            left = velocity + a;
            right = velocity + b;
        } else {
            const real alpha = law->alpha[node];
            const real beta = law->beta[node];
            left = (magnitude(alpha - 1) + roundings * unit) * a + magnitude(beta) * b + own[node];
            right = magnitude(alpha) * a + (magnitude(beta - 1) + roundings * unit) * b + own[node];
        }
        w->wave[half][LEFT][node + 1] = left;
        w->wave[half][RIGHT][node + 1] = right + more[node];
    }
}

/* What the outputs of a window may be wrong by. Of a wave that is heard, what is largest on this window and the one
 * before: its error, and the sums of its coefficients' magnitudes. */
static void outputs_wrong(const model_of *m, const laws *law, wrong *w, int degree)
{
    const real spare = (real)(64 * (degree + 4) * (NAME_PANELS + 1)) * least_number;
    real error[NAME_OUTPUTS];
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        error[output] = 0;
    }
    for (int k = 0; k < NAME_HEARD; ++k) {
        const real gain = magnitude(law->gain[k]);
        real wave = 0, size = 0, weight = 0;
        for (int panel = 0; w->way[k] == LOAD && panel < NAME_PANELS; ++panel) {
            const real *const c = m->force[panel][w->sender[k]];
            wave = larger(wave, w->force[panel][w->sender[k]]);
            size = larger(size, magnitude(c[0]) + magnitude(c[1]) + magnitude(c[2]));
            weight = 12 * size;
        }
        for (int half = 0; w->way[k] != LOAD && half < 2; ++half) {
            wave = larger(wave, w->wave[half][w->way[k]][w->sender[k]]);
            size = larger(size, w->most[half][w->way[k]][w->sender[k]][0]);
            weight = larger(weight, w->most[half][w->way[k]][w->sender[k]][1]);
        }
        /* a sum that is read loses 12 roundings of each coefficient times (k + 1)(k + 2) + degree */
        const real reading = 12 * (weight + (real)degree * size);
        const real summing = roundings + (real)(NAME_HEARD + 4);
        if (w->summed[k]) {
            const real total = magnitude(m->total[k]) + size;
            w->total[k] += wave + unit * (2 * (real)(degree + 16) * size + (real)(2 * NAME_PANELS + 2) * total) + spare;
            wave = w->total[k] + unit * ((summing + (real)(12 * (degree + 2))) * total + 2 * reading);
        } else {
            wave += unit * (summing * size + reading);
        }
        error[heard_output[k]] += gain * wave + spare;
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        w->output[output] = larger(w->output[output], error[output]);
    }
}

/* Where an output is larger than before, on a window that ends before TAU_MAX. */
static void remember(const model_of *m, wrong *w, int window)
{
    for (int output = 0; output < NAME_OUTPUTS && (real)window + 1 <= NAME_TAU_MAX; ++output) {
        if (m->largest[output] > w->largest[output]) {
            w->largest[output] = m->largest[output];
            w->window[output] = window;
        }
    }
}

/* What is seen of an output on the section with its largest mean. */
static real size_seen(const model_of *m, const wrong *w, int output)
{
    const int window = w->window[output];
    const real *const all = m->series + m->place[window];
    int section = 0;
    real largest = 0, most = 0;
    real t[BLOCK], values[BLOCK];
    for (int of = 0; of < SECTIONS && (real)window + from[of + 1] <= NAME_TAU_MAX; ++of) {
        const int at = of * NAME_OUTPUTS + output;
        real mean = 0;
        for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
            mean += all[(size_t)strand_at[k] * (size_t)(m->degree[window] + 2)];
        }
        if (magnitude(mean) > largest) {
            largest = magnitude(mean);
            section = of;
        }
    }
    for (int j = 0; j < BLOCK; ++j) {
        t[j] = from[section] + (from[section + 1] - from[section]) * (offset[j] / (real)BLOCK);
    }
    output_block(m, m->series, window, section * NAME_OUTPUTS + output, t, values);
    for (int j = 0; j < BLOCK && (real)window + t[j] <= NAME_TAU_MAX; ++j) {
        most = larger(most, values[j]);
    }
    return most;
}

int name_error_bound(name_model *model, const name_parameters *parameters, name_real *bound)
{
    laws law;
    wrong w;
    progress now = {0, LEAST, 0, 0, 0, 0, 0, 0, 0};
    int status = begun(model, parameters, &law);
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        bound[output] = not_a_number();
    }
    if (status) {
        return status;
    }
    begun_wrong(&w, &law);
    while (status == 0 && now.window < NAME_WINDOWS) {
        const int window = now.window;
        const int event = now.event;
        status = next_window(model, &law, &now);
        if (status == 0) {
            (void)pressed(&w, model->change, window, event);
            worsen(model, &law, &w, window % 2, now.degree);
            kept(model, &law, &now);
            outputs_wrong(model, &law, &w, now.degree);
            remember(model, &w, window);
        }
    }
    status = status ? status : ended(model, &law, &now);
    for (int output = 0; output < NAME_OUTPUTS && status == 0; ++output) {
        /* a hundredth for what is of second order in a rounding, and for the roundings of this here */
        const real error = w.output[output] * (real)1.01;
        const real size = size_seen(model, &w, output);
        bound[output] = error < size ? error / (size - error) * (1 + 4 * unit) : is_silent(&law, output) ? 0 : infinity();
    }
    return status;
}
