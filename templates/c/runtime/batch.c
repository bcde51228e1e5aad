/* batch.c: the march of runtime.c in lanes.
 * Plain C that stands below the text of lanes.c in generated files, which have what stands below the first empty
 * line. */
#include "lanes.c"

/* What parameters make of nodes, rods and outputs, of each set in its lane. */
typedef struct {
    wide alpha[NAME_NODES], beta[NAME_NODES], rate[NAME_NODES], motion[NAME_NODES];
    wide rod[NAME_NODES + 1], gain[NAME_HEARD + 1];
} laws_batch;

/* As tabulate: nodes whose laws are alike share a table. */
static void tabulate_batch(batch_of *b, const laws_batch *law, int degree)
{
    for (int k = 1; k <= degree + 1; ++k) {
        b->inverse[k] = 1 / (real)(2 * k);
    }
    for (int here = 0; here < NAME_PANELS * NAME_NODES; ++here) {
        const wide step = law->rate[here % NAME_NODES] * (2 * half_length[here / NAME_NODES]);
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
    *missed += MAGNITUDE(b->edge[row][LEAK] * (before - highest));
}

/* As march. */
static void march_batch(batch_of *b, const laws_batch *law, int window, int degree, wide *size, wide *missed)
{
    const int half = window % 2;
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
                moved_batch(b, row, &law->alpha[node], a, &law->beta[node], c, force, degree, &b->velocity[1][node], missed,
                            left, right);
                enlarge_batch(size, &b->velocity[1][node]);
            } else {
                passed(&law->alpha[node], a, &law->beta[node], c, force, degree, left, right);
            }
            enlarge_batch(size, left);
            enlarge_batch(size, right);
        }
    }
}

/* A set's laws into its lane; what they are in other lanes stays. */
static void spread(laws_batch *all, int set, const laws *law)
{
    (void)set;
    for (int node = 0; node < NAME_NODES; ++node) {
        LANE(all->alpha[node], set) = law->alpha[node];
        LANE(all->beta[node], set) = law->beta[node];
        LANE(all->rate[node], set) = law->rate[node];
        LANE(all->motion[node], set) = law->motion[node];
    }
    for (int node = 0; node <= NAME_NODES; ++node) {
        LANE(all->rod[node], set) = law->rod[node];
    }
    for (int k = 0; k < NAME_HEARD; ++k) {
        LANE(all->gain[k], set) = law->gain[k];
    }
}

/* At rest, or as rods move at first. */
static void started_batch(batch_of *b, const laws_batch *law)
{
    for (int half = 0; half < 2; ++half) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            for (int node = 0; node < NAME_NODES + 2; ++node) {
                for (int way = LEFT; way <= LOAD; ++way) {
                    for (int k = 0; k <= LEAST; ++k) {
                        b->waves[half][way][panel][node][k] = none;
                    }
                }
                if (node > 0) {
                    b->waves[half][LEFT][panel][node][0] = law->rod[node - 1];
                }
                if (node <= NAME_NODES) {
                    b->waves[half][RIGHT][panel][node][0] = law->rod[node];
                }
            }
        }
    }
    for (int node = 0; node < NAME_NODES; ++node) {
        b->velocity[0][node] = law->motion[node];
    }
    tabulate_batch(b, law, LEAST);
}

/* Series of another degree: what they had not is 0. */
static void raise_batch(batch_of *b, const laws_batch *law, int degree, int higher)
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
    tabulate_batch(b, law, higher);
}

/* The next window begins as this one ends. */
static void settle_batch(batch_of *b)
{
    for (int node = 0; node < NAME_NODES; ++node) {
        b->velocity[0][node] = b->velocity[1][node];
    }
}

static const wide *sent_batch(batch_of *b, int t, int window)
{
    return b->waves[(window + term_back[t]) % 2][term_way[t]][term_panel[t]][term_sender[t]];
}
