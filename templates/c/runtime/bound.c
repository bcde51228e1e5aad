/* bound.c: how wrong the waves of a model may be, from what it sends itself.
 * Plain C that stands below the text of wrong.c in generated files, which have what stands below the first empty
 * line. */
#include "wrong.c"

/* What may be wrong, at most; docs/march.md of wavesym has the proof. In short: let q be what a body sends plus what
 * arrived. How far q is from the law of the body is computed here, rounding included. That starts an error on this panel;
 * the energy of errors, the norm in which masses and waves are squared, never grows afterwards. */
typedef struct {
    real energy;                                          /* the norm of all errors so far */
    real wave[2][2][NAME_NODES + 2];                      /* the largest error of a wave, of both halves */
    slice read[2][NAME_NODES + 2];                        /* what reading a wave loses, at most */
    real load[NAME_FORCES + 1], load_read[NAME_FORCES + 1]; /* the same of a load that is heard */
    real end[NAME_NODES];
    real mass[NAME_NODES];               /* root of half the mass of a body */
    real moved[NAME_PANELS][NAME_NODES]; /* the energy of a velocity of size 1 on a panel, with waves as large */
    real all_moved;
    int way[NAME_HEARD + 1], sender[NAME_HEARD + 1]; /* which wave is heard */
    real held[NAME_HEARD + 1];                       /* what it was at first */
    wrong_beside beside;
} wrong;

/* Nothing is wrong but what laws are rounded by. Impedances follow from rod to rod, as alpha to beta. */
static void begun_wrong(work_of *m, const laws *law, wrong *w)
{
    const real rounded = roundings * unit;
    real impedance = 1;
    (void)m;
    begun_beside(&w->beside);
    w->energy = 0;
    w->all_moved = 0;
    for (int node = 0; node < NAME_NODES + 2; ++node) {
        const real left = node > 0 ? magnitude(law->rod[node - 1]) : 0;
        const real right = node <= NAME_NODES ? magnitude(law->rod[node]) : 0;
        w->wave[0][LEFT][node] = w->wave[1][LEFT][node] = rounded * left;
        w->wave[0][RIGHT][node] = w->wave[1][RIGHT][node] = rounded * right;
        w->read[LEFT][node] = w->read[RIGHT][node] = nothing;
    }
    for (int node = 0; node < NAME_NODES; ++node) {
        const real alpha = law->alpha[node];
        const real beta = law->beta[node];
        const real before = impedance;
        impedance = alpha > 0 && beta > 0 ? impedance * (beta / alpha) : impedance;
        const real mass = beta > 0 ? impedance / beta : before / alpha;
        const real half_mass = is_body[node] ? (law->rate[node] < least_number ? infinity() : mass / law->rate[node]) : 0;
        real moved_here = 0;
        w->mass[node] = root(half_mass);
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            const real length = 2 * half_length[panel];
            w->moved[panel][node] = root(is_body[node] ? half_mass + 2 * length * mass : length * (before + impedance));
            moved_here += w->moved[panel][node];
        }
        w->all_moved += moved_here;
        w->end[node] = law->motion[node];
        w->energy += rounded * moved_here * (magnitude(law->rod[node]) + magnitude(law->rod[node + 1]));
        w->energy += (rounded + unit) * w->mass[node] * magnitude(law->motion[node]);
    }
    for (int f = 0; f <= NAME_FORCES; ++f) {
        w->load[f] = w->load_read[f] = 0;
    }
    for (int t = 0; t < first_term[NAME_STRANDS]; ++t) {
        const int k = term_heard[t];
        w->way[k] = term_way[t];
        w->sender[k] = term_sender[t];
        w->held[k] = w->way[k] == LOAD ? 0 : magnitude(law->rod[w->sender[k] - (w->way[k] == LEFT)]);
    }
}

/* The first coefficient of a series counts twice in that of its integral. */
static const real doubled[17] = {2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};

/* A slice of q - p: what a node sends less what acts on it, of which `pushed` becomes the sum of absolute values. */
static void apart(const laws *law, int node, const real *a, const real *b, const real *left, const real *load, size_t k,
                  slice *much, slice *pushed)
{
    const slice from_left = law->alpha[node] * *slice_at(a, k);
    const slice from_right = law->beta[node] * *slice_at(b, k);
    slice p = from_left + from_right;
    *pushed = MAGNITUDE(from_left) + MAGNITUDE(from_right);
    if (k < 3) {
        const slice of_load = *slice_at(load, k);
        p += of_load;
        *pushed += MAGNITUDE(of_load);
    }
    *much = (*slice_at(left, k) + *slice_at(a, k)) - p;
}

/* What a node adds to the energy of errors on a panel, and its wave to the right to all that is unequal. What a node
 * without inertia sends is wrong by the number returned. */
static real defect(const work_of *m, const laws *law, wrong *w, int half, int panel, int node, int degree, slice *energy,
                   slice *unequal)
{
    const real *const a = m->waves[!half][RIGHT][panel][node];
    const real *const b = m->waves[!half][LEFT][panel][node + 2];
    const real *const left = m->waves[half][LEFT][panel][node + 1];
    const real *const right = m->waves[half][RIGHT][panel][node + 1];
    const int f = force_on[node];
    const real step = law->rate[node] * half_length[panel];
    const real few = 4 + (real)(degree / LANES + 12) * (w->mass[node] / w->moved[panel][node]); /* roundings of sums */
    real load[3 + LANES] = {0};
    slice missed = nothing, rounded = nothing, aparts = nothing, beyond = nothing, begins = nothing, ends = nothing;
    slice read_left = nothing, read_right = nothing;
    for (int k = 0; f >= 0 && k < 3; ++k) {
        load[k] = m->force[panel][f][k];
    }
    for (size_t k = 0; k <= (size_t)degree; k += LANES) {
        slice here, there, pushed, later;
        apart(law, node, a, b, left, load, k, &here, &pushed);
        apart(law, node, a, b, left, load, k + 2, &there, &later);
        const slice bent = step * *slice_at(m->inverse, k + 1) * (*slice_at(doubled, k > 0) * here - there);
        const slice rest = (*slice_at(left, k + 1) + *slice_at(a, k + 1)) + bent;
        const slice to_left = *slice_at(left, k), to_right = *slice_at(right, k);
        const slice sent = to_left + *slice_at(a, k);
        const slice more_right = (to_right - to_left) - (*slice_at(a, k) - *slice_at(b, k));
        const slice left_size = MAGNITUDE(to_left), right_size = MAGNITUDE(to_right);
        const slice size = left_size + MAGNITUDE(*slice_at(a, k));
        missed += MAGNITUDE(rest) + 3 * unit * MAGNITUDE(bent);
        read_left += *slice_at(w->beside.reading, k) * left_size;
        read_right += *slice_at(w->beside.reading, k) * right_size;
        aparts += MAGNITUDE(here);
        rounded += few * size + (roundings + 4) * pushed;
        beyond += MAGNITUDE(more_right) + unit * (size + right_size + MAGNITUDE(*slice_at(b, k)));
        begins += *slice_at(alternating, k % 2) * sent;
        ends += sent;
    }
    slice *const most_left = &w->read[LEFT][node + 1];
    slice *const most_right = &w->read[RIGHT][node + 1];
    *most_left = LARGER(read_left, *most_left); /* lane by lane: no sum of lanes has been larger */
    *most_right = LARGER(read_right, *most_right);
    *unequal += beyond;
    rounded = unit * (rounded + (roundings + 8) * aparts);
    const real moved_by = w->moved[panel][node];
    const real forced = f >= 0 ? w->beside.force[panel][f] : (real)0;
    w->energy += moved_by * forced;
    if (!is_body[node]) {
        *energy += moved_by * (aparts + rounded + beyond);
        aparts += rounded;
        return total_of(&aparts) + forced;
    }
    *energy += moved_by * (2 * missed + rounded + beyond);
    w->energy += w->mass[node] * magnitude(total_of(&begins) - w->end[node]);
    w->end[node] = total_of(&ends);
    return 0;
}

/* What a window adds to the errors, and how large those of its waves are. */
static void worsen(const work_of *m, const laws *law, wrong *w, int window, int degree)
{
    const int half = window % 2;
    real own[NAME_NODES];
    slice energy = nothing, unequal = nothing;
    for (int node = 0; node < NAME_NODES; ++node) {
        own[node] = 0;
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            own[node] = larger(own[node], defect(m, law, w, half, panel, node, degree, &energy, &unequal));
        }
    }
    for (int f = 0; f < NAME_FORCES; ++f) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            const real *const c = m->force[panel][f];
            const real size = magnitude(c[0]) + magnitude(c[1]) + magnitude(c[2]);
            w->load[f] = larger(w->load[f], w->beside.force[panel][f]);
            w->load_read[f] = larger(w->load_read[f], w->beside.reading[2] * size);
        }
    }
    const real spare = (real)(256 * (degree + 4)) * least_number;
    const real more = total_of(&unequal) + spare;
    w->energy += total_of(&energy) + w->all_moved * spare;
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
        w->energy = finite_number(left) && finite_number(right) ? w->energy : infinity();
        w->wave[half][LEFT][node + 1] = larger(w->wave[!half][LEFT][node + 1], left + spare);
        w->wave[half][RIGHT][node + 1] = larger(w->wave[!half][RIGHT][node + 1], right + more);
    }
}

/* Of a wave that is heard the largest error so far, and what reading it loses at most. */
static void wrong_heard(const wrong *w, int k, int window, real *error, real *read)
{
    const int sender = w->sender[k];
    if (w->way[k] == LOAD) {
        *error = w->load[sender];
        *read = w->load_read[sender];
    } else {
        *error = w->wave[window % 2][w->way[k]][sender];
        *read = total_of(&w->read[w->way[k]][sender]) + w->beside.reading[0] * w->held[k];
    }
}
