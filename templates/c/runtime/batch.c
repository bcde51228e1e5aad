/* batch.c: the march of runtime.c in lanes.
 * Plain C that stands below the text of lanes.c in generated files, which have what stands below the first empty
 * line. */
#include "lanes.c"

/* What it takes to build the sets of a part: name_set of each of them. */
typedef struct {
    wide waves[2][3][NAME_PANELS][NAME_NODES + 2][NAME_DEGREE + 1];
    wide velocity[2][NAME_NODES];
    wide table[NAME_PANELS * NAME_NODES][3][NAME_DEGREE + 2];
    wide edge[NAME_PANELS * NAME_NODES][3];
    wide total[NAME_HEARD + 1];
    wide change[NAME_EVENTS + 1];
    wide load[NAME_FORCES + 1][3];
    wide force[NAME_PANELS][NAME_FORCES + 1][3];
    wide largest[NAME_OUTPUTS];
    wide mean[NAME_OUTPUTS];
    wide worth[NAME_OUTPUTS];
    wide sum[NAME_DEGREE + 2];
} part_of;

/* What parameters make of nodes, rods and outputs, of each set in its lane. */
typedef struct {
    wide alpha[NAME_NODES], beta[NAME_NODES], rate[NAME_NODES], motion[NAME_NODES];
    wide rod[NAME_NODES + 1], gain[NAME_HEARD + 1];
} laws_batch;

/* So many parts go side by side, as each step of a body waits for the one before. */
enum { ABREAST_PARTS = PARTS < 4 ? PARTS : 4 };

/* As tabulate, of some parts: nodes whose laws are alike share a table. */
static void tabulate_some(part_of *p, const laws_batch *law, int degree)
{
    for (int here = 0; here < NAME_PANELS * NAME_NODES; ++here) {
        const int node = here % NAME_NODES;
        wide step[ABREAST_PARTS], ratio[ABREAST_PARTS], first[ABREAST_PARTS], last[ABREAST_PARTS];
        if (alike[here] != here || !is_body[node]) {
            continue;
        }
        UNROLLED
        for (int j = 0; j < ABREAST_PARTS; ++j) {
            step[j] = law[j].rate[node] * (2 * half_length[here / NAME_NODES]);
            ratio[j] = first[j] = last[j] = none;
        }
        for (int k = degree; k > 0; --k) {
            UNROLLED
            for (int j = 0; j < ABREAST_PARTS; ++j) {
                const wide above = ratio[j];
                ratio[j] = step[j] / ((real)(4 * k) + step[j] * above);
                first[j] = (real)(k % 2 ? -1 : 1) - above * first[j];
                last[j] = 1 - above * last[j];
                p[j].table[here][RATIO][k] = ratio[j];
                p[j].table[here][FIRST][k] = first[j];
                p[j].table[here][LAST][k] = last[j];
            }
        }
        for (int j = 0; j < ABREAST_PARTS; ++j) {
            const wide begun = 2 * ratio[j] * first[j];
            p[j].edge[here][SLACK] = -begun / (1 - begun);
            p[j].edge[here][LOSS] = 2 * ratio[j] * last[j];
            p[j].edge[here][LEAK] = step[j] / (real)(4 * (degree + 1));
        }
    }
}

static void tabulate_parts(part_of *p, const laws_batch *law, int degree)
{
    for (int side = 0; side < PARTS; side += ABREAST_PARTS) {
        tabulate_some(p + side, law + side, degree);
    }
}

/* As march does it at a node without inertia. */
static void passed(part_of *p, const laws_batch *law, int half, int panel, int node, int degree)
{
    const wide alpha = law->alpha[node], beta = law->beta[node];
    const wide *const a = p->waves[!half][RIGHT][panel][node];
    const wide *const c = p->waves[!half][LEFT][panel][node + 2];
    const wide *const force = force_on[node] < 0 ? NULL : p->force[panel][force_on[node]];
    for (int k = 0; k <= degree; ++k) {
        const wide sum = alpha * a[k] + beta * c[k];
        const wide sent = force && k < 3 ? (wide)(sum + force[k]) : sum;
        p->waves[half][LEFT][panel][node + 1][k] = sent - a[k];
        p->waves[half][RIGHT][panel][node + 1][k] = sent - c[k];
    }
}

/* As moved and march at a body, both at once; what the polynomials miss is added. */
static void moved_batch(part_of *p, const laws_batch *law, int half, int panel, int node, int degree, wide *missed)
{
    const int row = alike[panel * NAME_NODES + node], f = force_on[node];
    wide alpha[ABREAST_PARTS], beta[ABREAST_PARTS], highest[ABREAST_PARTS], above[ABREAST_PARTS], here[ABREAST_PARTS], y[ABREAST_PARTS], begun[ABREAST_PARTS], ended[ABREAST_PARTS];
    UNROLLED
    for (int j = 0; j < ABREAST_PARTS; ++j) {
        alpha[j] = law[j].alpha[node];
        beta[j] = law[j].beta[node];
        here[j] = alpha[j] * p[j].waves[!half][RIGHT][panel][node][degree] +
                  beta[j] * p[j].waves[!half][LEFT][panel][node + 2][degree];
        highest[j] = here[j];
        above[j] = y[j] = begun[j] = ended[j] = none;
    }
    for (int k = degree; k > 0; --k) {
        UNROLLED
        for (int j = 0; j < ABREAST_PARTS; ++j) {
            wide below = alpha[j] * p[j].waves[!half][RIGHT][panel][node][k - 1] +
                         beta[j] * p[j].waves[!half][LEFT][panel][node + 2][k - 1];
            if (f >= 0 && k <= 3) {
                below += p[j].force[panel][f][k - 1];
            }
            y[j] = p[j].table[row][RATIO][k] * (((k == 1 ? (wide)(2 * below) : below) - above[j]) + y[j]);
            p[j].sum[k] = y[j];
            begun[j] += p[j].table[row][FIRST][k] * y[j];
            ended[j] += p[j].table[row][LAST][k] * y[j];
            above[j] = here[j];
            here[j] = below;
        }
    }
    UNROLLED
    for (int j = 0; j < ABREAST_PARTS; ++j) {
        const wide *const edge = p[j].edge[row];
        const wide rest = p[j].velocity[1][node] - begun[j];
        const wide mean = rest - edge[SLACK] * rest;
        p[j].velocity[1][node] = mean + (ended[j] - edge[LOSS] * mean);
        p[j].waves[half][LEFT][panel][node + 1][0] = mean - p[j].waves[!half][RIGHT][panel][node][0];
        p[j].waves[half][RIGHT][panel][node + 1][0] = mean - p[j].waves[!half][LEFT][panel][node + 2][0];
        y[j] = 2 * mean;
    }
    for (int k = 1; k <= degree; ++k) {
        UNROLLED
        for (int j = 0; j < ABREAST_PARTS; ++j) {
            y[j] = p[j].sum[k] - p[j].table[row][RATIO][k] * y[j];
            p[j].waves[half][LEFT][panel][node + 1][k] = y[j] - p[j].waves[!half][RIGHT][panel][node][k];
            p[j].waves[half][RIGHT][panel][node + 1][k] = y[j] - p[j].waves[!half][LEFT][panel][node + 2][k];
        }
    }
    UNROLLED
    for (int j = 0; j < ABREAST_PARTS; ++j) {
        missed[j] += MAGNITUDES(p[j].edge[row][LEAK] * (y[j] - highest[j]));
    }
}

/* As march. */
static void march_parts(part_of *p, const laws_batch *law, int window, int degree, wide *size, wide *missed)
{
    const int half = window % 2;
    for (int side = 0; side < PARTS; ++side) {
        for (int node = 0; node < NAME_NODES; ++node) {
            p[side].velocity[1][node] = p[side].velocity[0][node];
        }
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            for (int f = 0; f < NAME_FORCES; ++f) {
                for (int k = 0; k < 3; ++k) {
                    p[side].waves[half][LOAD][panel][f][k] = p[side].force[panel][f][k];
                }
            }
        }
    }
    for (int side = 0; side < PARTS; side += ABREAST_PARTS) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            for (int node = 0; node < NAME_NODES; ++node) {
                if (is_body[node]) {
                    moved_batch(p + side, law + side, half, panel, node, degree, missed + side);
                }
                for (int j = side; j < side + ABREAST_PARTS; ++j) {
                    if (is_body[node]) {
                        enlarge_batch(size + j, &p[j].velocity[1][node]);
                    } else {
                        passed(p + j, law + j, half, panel, node, degree);
                    }
                    enlarge_batch(size + j, p[j].waves[half][LEFT][panel][node + 1]);
                    enlarge_batch(size + j, p[j].waves[half][RIGHT][panel][node + 1]);
                }
            }
        }
    }
}

/* A set's laws into its lane; what they are in other lanes stays. */
static void spread(laws_batch *all, int lane, const laws *law)
{
    (void)lane;
    for (int node = 0; node < NAME_NODES; ++node) {
        AT(all->alpha[node], lane) = law->alpha[node];
        AT(all->beta[node], lane) = law->beta[node];
        AT(all->rate[node], lane) = law->rate[node];
        AT(all->motion[node], lane) = law->motion[node];
    }
    for (int node = 0; node <= NAME_NODES; ++node) {
        AT(all->rod[node], lane) = law->rod[node];
    }
    for (int k = 0; k < NAME_HEARD; ++k) {
        AT(all->gain[k], lane) = law->gain[k];
    }
}

/* At rest, or as rods move at first. */
static void started_batch(part_of *b, const laws_batch *law)
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
}

/* Series of another degree: what they had not is 0. */
static void raise_batch(part_of *b, int degree, int higher)
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

/* The next window begins as this one ends. */
static void settle_batch(part_of *b)
{
    for (int node = 0; node < NAME_NODES; ++node) {
        b->velocity[0][node] = b->velocity[1][node];
    }
}

static const wide *sent_batch(part_of *b, int t, int window)
{
    return b->waves[(window + term_back[t]) % 2][term_way[t]][term_panel[t]][term_sender[t]];
}
