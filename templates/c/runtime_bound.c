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
    real force[NAME_PANELS][NAME_FORCES + 1]; /* of a load, on this window */
    real total[NAME_HEARD + 1];               /* of an integral */
    real end[NAME_NODES], end_error[NAME_NODES];
    real mass[NAME_NODES];                    /* root of half the mass of a body */
    real sent[NAME_PANELS][NAME_NODES];       /* the energy of waves of size 1 on a panel, to both sides */
    real moved[NAME_PANELS][NAME_NODES];      /* and that of a velocity as large, with its waves */
    real load[NAME_FORCES + 1][3], roundings[NAME_FORCES + 1];
    int since[NAME_FORCES + 1][2];
    real output[NAME_OUTPUTS];
} wrong;

/* No less than the root. */
static real root(real x)
{
    real y = 1;
    if (!(x > 0) || !finite_number(x)) {
        return x > 0 ? infinity() : 0;
    }
    while (y < x / y) {
        y *= 2;
    }
    while (y / 4 > x / y) {
        y /= 2;
    }
    for (int k = 0; k < 8; ++k) {
        y = (y + x / y) / 2;
    }
    return y * (1 + 4 * unit);
}

/* Nothing is wrong but what laws are rounded by. Impedances follow from rod to rod, as alpha to beta. */
static void begun_wrong(wrong *w, const laws *law)
{
    real impedance = 1;
    const real rounded = roundings * unit;
    for (int half = 0; half < 2; ++half) {
        for (int node = 0; node < NAME_NODES + 2; ++node) {
            w->wave[half][LEFT][node] = node > 0 ? rounded * magnitude(law->rod[node - 1]) : 0;
            w->wave[half][RIGHT][node] = node <= NAME_NODES ? rounded * magnitude(law->rod[node]) : 0;
            for (int panel = 0; panel < NAME_PANELS; ++panel) {
                w->size[half][LEFT][panel][node] = node > 0 ? magnitude(law->rod[node - 1]) : 0;
                w->size[half][RIGHT][panel][node] = node <= NAME_NODES ? magnitude(law->rod[node]) : 0;
            }
        }
    }
    w->energy = 0;
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
        w->roundings[f] = roundings + 4;
        w->since[f][0] = w->since[f][1] = 0;
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            w->force[panel][f] = 0;
        }
    }
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        w->output[output] = 0;
    }
}

/* As press, with the absolute values of all that is added. */
static int pressed(wrong *w, const real *change, int window, int event)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        while (event < NAME_EVENTS && event_window[event] == window && event_panel[event] == panel) {
            const int f = event_force[event];
            real *const c = w->load[f];
            const real gone = (real)(window - w->since[f][0] + 1);
            c[0] += gone * (c[1] + gone * c[2]);
            c[1] += 2 * gone * c[2];
            c[event_power[event]] += magnitude(change[event]);
            w->since[f][0] = window;
            w->since[f][1] = panel;
            w->roundings[f] += 8;
            ++event;
        }
        for (int f = 0; f < NAME_FORCES; ++f) {
            const real *const c = w->load[f];
            const real gone = (real)(window - w->since[f][0] + 2);
            w->force[panel][f] = (w->roundings[f] + 12) * unit * (c[0] + 2 * gone * (c[1] + 2 * gone * c[2]));
        }
    }
    return event;
}

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
    real apart[NAME_DEGREE + 3]; /* q - p */
    real q[NAME_DEGREE + 1];
    real pushes = 0, lefts = 0, rights = 0, sent = 0, aparts = 0, unequal = 0;
    for (int k = 0; k <= degree; ++k) {
        const real from_left = alpha * a[k];
        const real from_right = beta * b[k];
        const real load = f >= 0 && k < 3 ? m->force[panel][f][k] : (real)0;
        const real pushed = magnitude(from_left) + magnitude(from_right) + magnitude(load);
        const real one = right[k] - left[k];
        const real other = a[k] - b[k];
        q[k] = left[k] + a[k];
        apart[k] = q[k] - ((from_left + from_right) + load);
        pushes += pushed;
        lefts += magnitude(left[k]);
        rights += magnitude(right[k]);
        sent += magnitude(q[k]);
        aparts += magnitude(apart[k]);
        unequal += magnitude(one - other) + unit * (magnitude(one) + magnitude(other));
    }
    *more = unequal;
    const real sizes = lefts + w->size[!half][RIGHT][panel][node] + pushes;
    w->size[half][LEFT][panel][node + 1] = lefts;
    w->size[half][RIGHT][panel][node + 1] = rights;
    const real pushed_wrong = unit * (2 * sizes + (roundings + 2) * pushes + (roundings + 8) * aparts) +
                              (f >= 0 ? w->force[panel][f] : (real)0) + spare;
    if (!is_body[node]) {
        *velocity = aparts + pushed_wrong;
        return;
    }
    const real step = law->rate[node] * half_length[panel];
    real missed = step * m->inverse[degree + 1] * magnitude(apart[degree]) + spare;
    real some[4] = {q[0], 0, 0, 0};
    apart[degree + 1] = 0;
    for (int k = 1; k <= degree; ++k) {
        const real change = (k == 1 ? 2 * apart[0] : apart[k - 1]) - apart[k + 1];
        const real bent = step * m->inverse[k] * change;
        missed += magnitude(q[k] + bent) + unit * (magnitude(q[k]) + 3 * magnitude(bent));
        some[k % 4] += q[k];
    }
    const real even = some[0] + some[2];
    const real odd = some[1] + some[3];
    const real summing = unit * ((real)degree / 8 + 3) * sent + spare;
    const real jump = magnitude((even - odd) - w->end[node]) + unit * (sent + magnitude(w->end[node]));
    *velocity = 2 * missed + (jump + summing + w->end_error[node]) + pushed_wrong;
    w->end[node] = even + odd;
    w->end_error[node] = summing + unit * sent;
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

/* What the outputs of a window may be wrong by. */
static void outputs_wrong(const model_of *m, const laws *law, wrong *w, int window, int degree)
{
    const int half = window % 2;
    real strand[NAME_STRANDS];
    const real spare = (real)(64 * (degree + 4)) * least_number;
    for (int s = 0; s < NAME_STRANDS; ++s) {
        const real *const c = m->series + m->place[window] + (size_t)s * (size_t)(degree + 2);
        const real terms = (real)(first_term[s + 1] - first_term[s]);
        strand[s] = spare;
        real weight = (real)(degree + 2), more = 4, reading = 0; /* (k + 1)(k + 2) + degree */
        for (int k = 0; k <= degree + 1; ++k) {
            reading += weight * magnitude(c[k]);
            weight += more;
            more += 2;
        }
        strand[s] += 12 * unit * reading;
        for (int t = first_term[s]; t < first_term[s + 1]; ++t) {
            const int then = term_back[t] ? !half : half;
            const int way = term_way[t];
            const int heard = term_heard[t];
            const real length = 2 * half_length[term_panel[t]];
            const real gain = magnitude(law->gain[heard]);
            const real sender = way == LOAD ? w->force[term_panel[t]][term_sender[t]] : w->wave[then][way][term_sender[t]];
            const real *const load = m->waves[then][LOAD][term_panel[t]][term_sender[t]];
            const real size = way == LOAD ? magnitude(load[0]) + magnitude(load[1]) + magnitude(load[2])
                                          : w->size[then][way][term_panel[t]][term_sender[t]];
            if (term_summed[t]) {
                const real total = magnitude(m->total[heard]) + length * size;
                w->total[heard] += length * sender + unit * ((real)(degree + 16) * length * size + 2 * total) + spare;
                strand[s] += gain * (w->total[heard] + unit * (roundings + terms + 4) * (total + length * size));
            } else {
                strand[s] += gain * (sender + unit * (roundings + terms + 4) * size);
            }
        }
    }
    for (int section = 0; section < SECTIONS && (real)window + from[section] <= NAME_TAU_MAX; ++section) {
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            const int at = section * NAME_OUTPUTS + output;
            real sum = 0;
            for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
                sum += strand[strand_at[k]];
            }
            w->output[output] = larger(w->output[output], sum);
        }
    }
}

int name_error_bound(name_model *model, const name_parameters *parameters, name_real *bound)
{
    laws law;
    wrong w;
    progress now = {0, LEAST, 0, 0, 0, 0, 0};
    int status = begun(model, parameters, &law);
    if (status == 0) {
        begun_wrong(&w, &law);
    }
    while (status == 0 && now.window < NAME_WINDOWS) {
        const int window = now.window;
        const int event = now.event;
        status = next_window(model, &law, &now);
        if (status == 0) {
            (void)pressed(&w, model->change, window, event);
            worsen(model, &law, &w, window % 2, now.degree);
            kept(model, &law, &now);
            outputs_wrong(model, &law, &w, window, now.degree);
        }
    }
    status = status ? status : ended(model, &law, &now);
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        bound[output] = not_a_number();
        if (status == 0) {
            /* a hundredth for what is of second order in a rounding, and for the roundings of this here */
            const real error = w.output[output] * (real)1.01;
            const real most = model->largest[output];
            real weight = 0; /* 0 for an output that is 0 whatever the parameters are */
            for (int k = 0; k < NAME_HEARD; ++k) {
                weight += heard_output[k] == output ? magnitude(law.gain[k]) : (real)0;
            }
            bound[output] = error < most ? error / (most - error) * (1 + 4 * unit) : weight > 0 ? infinity() : (real)0;
        }
    }
    return status;
}
