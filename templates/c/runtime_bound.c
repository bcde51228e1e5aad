/* runtime_bound.c: how wrong the waves of a model may be, from what it sends itself.
 * Plain C that stands below the text of runtime_wrong.c in generated files, which have what stands below the first empty
 * line. */
#include "runtime_wrong.c"

/* What may be wrong, at most; docs/march.md of wavesym has the proof. In short: let q be what a body sends plus what
 * arrived. How far q is from the law of the body is computed here, rounding included. That starts an error on this panel;
 * the energy of errors, the norm in which masses and waves are squared, never grows afterwards. */
typedef struct {
    real energy;                              /* the norm of all errors so far */
    real wave[2][2][NAME_NODES + 2];          /* the largest error of a wave on a window, of both halves */
    real size[2][2][NAME_PANELS][NAME_NODES + 2]; /* of a wave the sum of its coefficients' magnitudes */
    real end[NAME_NODES], end_error[NAME_NODES];
    real mass[NAME_NODES];                    /* root of half the mass of a body */
    real sent[NAME_PANELS][NAME_NODES];       /* the energy of waves of size 1 on a panel, to both sides */
    real moved[NAME_PANELS][NAME_NODES];      /* and that of a velocity as large, with its waves */
    wrong_beside beside;
} wrong;

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
    begun_beside(&w->beside);
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
                              (f >= 0 ? w->beside.force[panel][f] : (real)0) + spare;
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
static void worsen(const model_of *m, const laws *law, wrong *w, int window, int degree)
{
    const int half = window % 2;
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

/* Of a wave that is heard on a window the largest error, and its size. */
static void wrong_heard(const model_of *m, const wrong *w, int t, int window, real *error, real *size)
{
    const int then = (window + term_back[t]) % 2;
    const int way = term_way[t];
    const real *const load = m->waves[then][LOAD][term_panel[t]][term_sender[t]];
    *error = way == LOAD ? w->beside.force[term_panel[t]][term_sender[t]] : w->wave[then][way][term_sender[t]];
    *size = way == LOAD ? magnitude(load[0]) + magnitude(load[1]) + magnitude(load[2])
                        : w->size[then][way][term_panel[t]][term_sender[t]];
}
