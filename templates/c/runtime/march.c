/* march.c: joints on a window: their tables, how they move, what they send. Generated files have it twice, for one set of
 * parameters and for a set in each lane of a vector: `num` is a number of each set, OF(name) what is called name. */
#include "../polynomials.c"
#include "../elimination.c"

#ifndef STEPS
#define STEPS
/* Bodies are stepped side by side: each step of a recurrence waits for the one before. */
enum { ABREAST_BODIES = 2 };

/* Where each track has what is sent into it on a window, and what arrives from it: the oldest that it has. */
typedef struct {
    int sent[NAME_TRACKS], arrived[NAME_TRACKS];
} places;

static void locate(int window, places *now)
{
    for (int track = 0; track < NAME_TRACKS; ++track) {
        const int sent = slot(track, window, 0);
        now->sent[track] = sent;
        now->arrived[track] = sent < ring[track] + steps[track] ? sent + 1 : ring[track];
    }
}
#endif

/* y += factor a, of series to a degree; zeros behind them stay */
static void OF(add)(num *y, const num *factor, const num *a, int degree)
{
    for (int k = 0; k <= degree; k += OF(packed)) {
        *(OF(pack) *)(y + k) += *factor * *(const OF(pack) *)(a + k);
    }
}

static void OF(clear)(num *x, int count)
{
    for (int k = 0; k < count; ++k) {
        x[k] = ZERO;
    }
}

/* Where the matrices of a block are. */
static void OF(locate_block)(OF(march_tables) *m, int joint, int panel, OF(block_tables) *block)
{
    block->n = states_of(joint);
    block->stride = NAME_SQUARES;
    block->solve = m->solver[panel][0] + at_square[joint];
    block->down = m->solver[panel][1] + at_square[joint];
    block->first = m->solver[panel][2] + at_square[joint];
    block->last = m->solver[panel][3] + at_square[joint];
    block->start = m->edge[panel][0] + at_square[joint];
    block->end = m->edge[panel][1] + at_square[joint];
}

/* All tables, of so many sets (or vectors of sets). */
static void OF(tabulate)(OF(march_tables) *all, const OF(laws) *law, int sets, int degree)
{
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        const real half = half_length[panel];
        for (int body = 0; body < NAME_BODIES; ++body) {
            const int joint = body_joint[body];
            for (int set = 0; set < sets; ++set) {
                const num rate = -law[set].rates[at_rates[joint]];
                OF(tabulate_body)(all[set].body[panel][body], &rate, 2 * half, degree);
                all[set].drive[body] = law[set].pushed[at_pushed[joint]] / rate;
            }
        }
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            for (int set = 0; set < sets && is_block(joint); ++set) {
                OF(block_tables) block;
                OF(locate_block)(all + set, joint, panel, &block);
                OF(tabulate_block)(&block, law[set].rates + at_rates[joint], half, degree);
            }
        }
    }
}

/* What acts on a derivative as laws change, where they do, as series: on points, with loads, on states, and on velocities
 * of points. */
typedef struct {
    int changed[NAME_JOINTS];
    num (*acting)[NAME_POINTS][NAME_ROW], (*moving)[NAME_STATES + 1][NAME_ROW], (*shifted)[NAME_POINTS][NAME_ROW];
} OF(forcing);

/* What acts on a point besides waves, a series of so many coefficients: loads, or a forcing. */
static int OF(acting_on)(OF(march_state) *m, const OF(forcing) *by, int joint, int point, int panel, int degree,
                         const num **acting)
{
    const int force = force_on[point];
    if (by && by->changed[joint]) {
        *acting = by->acting[panel][point];
        return degree + 1;
    }
    *acting = m->force[panel][NAME_FORCES > 0 && force >= 0 ? force : 0];
    return NAME_FORCES > 0 && force >= 0 ? 3 : 0;
}

/* What acts on the points of a joint on a panel, as series: what waves do of all but `skipped` of its ends at both sides. */
static void OF(gather)(OF(march_state) *m, const OF(laws) *law, const OF(forcing) *by, int joint, int panel,
                       const places *now, int degree, int skipped, num (*s)[NAME_ROW])
{
    for (int point = 0; point < points_of(joint); ++point) {
        const num *acting;
        const int count = OF(acting_on)(m, by, joint, first_point[joint] + point, panel, degree, &acting);
        for (int k = 0; k < degree + SPARE; ++k) {
            s[point][k] = k < count ? acting[k] : ZERO;
        }
    }
    for (int port = first_port[joint] + skipped; port < first_port[joint + 1] - skipped; ++port) {
        OF(add)(s[point_of[port]], &law->push[port], m->waves[now->arrived[arrive[port]]][panel], degree);
    }
}

/* Up to ABREAST_BODIES bodies on a panel: their tables and rates, what arrives at the first and the last end, times drives,
 * what acts besides, what goes back, velocities, states, and where sizes of waves and truncation errors are collected. */
typedef struct {
    int count;
    const num *table[ABREAST_BODIES], *a[ABREAST_BODIES], *b[ABREAST_BODIES], *acting[ABREAST_BODIES];
    int most[ABREAST_BODIES];
    num rate[ABREAST_BODIES], drive[ABREAST_BODIES], one[ABREAST_BODIES], other[ABREAST_BODIES];
    num *left[ABREAST_BODIES], *right[ABREAST_BODIES];
    real on_left[ABREAST_BODIES], on_right[ABREAST_BODIES];
    num *q[ABREAST_BODIES], *state[ABREAST_BODIES], *size[ABREAST_BODIES], *missed[ABREAST_BODIES];
} OF(bodies);

/* `count` of them. */
WITHIN void OF(step_abreast)(OF(bodies) *e, int count, real half, int degree)
{
    num y[ABREAST_BODIES], at_first[ABREAST_BODIES], at_last[ABREAST_BODIES], above[ABREAST_BODIES], here[ABREAST_BODIES];
    num highest[ABREAST_BODIES], one[ABREAST_BODIES], other[ABREAST_BODIES];
    const num *table[ABREAST_BODIES], *a[ABREAST_BODIES], *b[ABREAST_BODIES];
    num *q[ABREAST_BODIES], *left[ABREAST_BODIES], *right[ABREAST_BODIES];
    real on_left[ABREAST_BODIES], on_right[ABREAST_BODIES];
    int most = 0;
    UNROLLED
    for (int j = 0; j < count; ++j) {
        table[j] = e->table[j];
        a[j] = e->a[j];
        b[j] = e->b[j];
        q[j] = e->q[j];
        left[j] = e->left[j];
        right[j] = e->right[j];
        on_left[j] = e->on_left[j];
        on_right[j] = e->on_right[j];
        one[j] = e->one[j];
        other[j] = e->other[j];
        most = e->most[j] > most ? e->most[j] : most;
        here[j] = one[j] * a[j][degree] + other[j] * b[j][degree];
        if (e->most[j] > degree) {
            here[j] += e->drive[j] * e->acting[j][degree];
        }
        highest[j] = here[j];
        above[j] = y[j] = at_first[j] = at_last[j] = ZERO;
    }
    for (int k = degree; k > 0; --k) {
        UNROLLED
        for (int j = 0; j < count; ++j) {
            num below = one[j] * a[j][k - 1] + other[j] * b[j][k - 1];
            if (k <= most && k <= e->most[j]) {
                below += e->drive[j] * e->acting[j][k - 1];
            }
            const num change = (k == 1 ? (num)(2 * below) : below) - above[j];
            const num *const row = table[j] + 3 * k;
            y[j] = row[RATIO] * y[j] + row[RATIO] * change;
            q[j][k] = y[j];
            at_first[j] += row[SUM_FIRST] * y[j];
            at_last[j] += row[SUM_LAST] * y[j];
            above[j] = here[j];
            here[j] = below;
        }
    }
    UNROLLED
    for (int j = 0; j < count; ++j) {
        const num rest = *e->state[j] - at_first[j];
        const num mean = rest - table[j][SLACK] * rest;
        *e->state[j] = mean + (at_last[j] - table[j][LOSS] * mean);
        q[j][0] = mean;
        left[j][0] = on_left[j] * mean - a[j][0];
        right[j][0] = on_right[j] * mean - b[j][0];
        OF(enlarge)(e->size[j], e->state[j]);
        OF(enlarge)(e->size[j], left[j]);
        OF(enlarge)(e->size[j], right[j]);
    }
    UNROLLED
    for (int j = 0; j < count; ++j) {
        y[j] = 2 * q[j][0];
    }
    for (int k = 1; k <= degree; ++k) {
        UNROLLED
        for (int j = 0; j < count; ++j) {
            y[j] = q[j][k] - table[j][3 * k + RATIO] * y[j];
            left[j][k] = on_left[j] * y[j] - a[j][k];
            right[j][k] = on_right[j] * y[j] - b[j][k];
        }
        UNROLLED
        for (int j = 0; j < count; ++j) {
            q[j][k] = y[j];
        }
    }
    UNROLLED
    for (int j = 0; j < count; ++j) {
        const num rest = (highest[j] - y[j]) * (e->rate[j] * (half / (real)(2 * (degree + 1))));
        OF(add_magnitude)(e->missed[j], &rest);
    }
}

/* All that there are: bodies that are stepped side by side need not wait for each other. */
static void OF(step_bodies)(OF(bodies) *e, real half, int degree)
{
    if (e->count == ABREAST_BODIES) {
        OF(step_abreast)(e, ABREAST_BODIES, half, degree);
    } else if (e->count > 0) {
        OF(step_abreast)(e, 1, half, degree);
    }
    e->count = 0;
}

/* What ends send: velocities of their points, less what arrives; of all ends but `skipped` at both sides. */
static void OF(send_back)(OF(march_state) *m, int joint, int panel, const places *now, int degree, int skipped,
                          num (*q)[NAME_ROW], num *size)
{
    for (int port = first_port[joint] + skipped; port < first_port[joint + 1] - skipped; ++port) {
        const num *const a = m->waves[now->arrived[arrive[port]]][panel];
        num *const out = m->waves[now->sent[send[port]]][panel];
        for (int k = 0; k <= degree; ++k) {
            out[k] = ratio[port] * q[point_of[port]][k] - a[k];
        }
        OF(enlarge)(size, out);
    }
}

/* All bodies of some sets on a panel. */
static void OF(march_bodies)(OF(march_state) *all, OF(march_tables) *tables, const OF(laws) *law, int sets, int panel,
                             const places *now, int degree, const OF(forcing) *by, num *size, num *missed)
{
    OF(bodies) some;
    some.count = 0;
    for (int body = 0; body < NAME_BODIES; ++body) {
        const int joint = body_joint[body];
        const int port = first_port[joint], next = first_port[joint + 1] - 1;
        for (int set = 0; set < sets; ++set) {
            OF(march_state) *const m = all + set;
            const int j = some.count++;
            some.table[j] = tables[set].body[panel][body][0];
            some.rate[j] = -law[set].rates[at_rates[joint]];
            some.drive[j] = tables[set].drive[body];
            some.a[j] = m->waves[now->arrived[arrive[port]]][panel];
            some.b[j] = m->waves[now->arrived[arrive[next]]][panel];
            some.left[j] = m->waves[now->sent[send[port]]][panel];
            some.right[j] = m->waves[now->sent[send[next]]][panel];
            some.one[j] = some.drive[j] * law[set].push[port];
            some.other[j] = next > port ? (num)(some.drive[j] * law[set].push[next]) : ZERO;
            some.on_left[j] = ratio[port];
            some.on_right[j] = ratio[next];
            some.q[j] = m->path[panel][first_state[joint]];
            some.state[j] = &m->state[1][first_state[joint]];
            some.size[j] = size + set;
            some.missed[j] = missed + set;
            some.most[j] = OF(acting_on)(m, by, joint, first_point[joint], panel, degree, &some.acting[j]);
            if (next > port + 1) { /* what other ends do is where the velocity will be, which no longer needs it then */
                OF(gather)(m, law + set, by, joint, panel, now, degree, 1, m->path[panel] + first_state[joint]);
                some.acting[j] = some.q[j];
                some.most[j] = degree + 1;
            }
            if (some.count == ABREAST_BODIES) {
                OF(step_bodies)(&some, half_length[panel], degree);
            }
        }
    }
    OF(step_bodies)(&some, half_length[panel], degree);
    for (int body = 0; body < NAME_BODIES; ++body) {
        const int joint = body_joint[body];
        for (int set = 0; set < sets && first_port[joint + 1] - first_port[joint] > 2; ++set) {
            OF(send_back)(all + set, joint, panel, now, degree, 1, all[set].path[panel] + first_state[joint], size + set);
        }
    }
}

/* A point without state between at most two ends, in one pass. */
static BY_ITSELF void OF(scatter)(OF(march_state) *m, const OF(laws) *law, int joint, int panel, const places *now,
                                  int degree, num *size)
{
    const int port = first_port[joint], next = first_port[joint + 1] - 1, force = force_on[first_point[joint]];
    const num *const a = m->waves[now->arrived[arrive[port]]][panel];
    const num *const b = m->waves[now->arrived[arrive[next]]][panel];
    num *const left = m->waves[now->sent[send[port]]][panel];
    num *const right = m->waves[now->sent[send[next]]][panel];
    const num one = law->push[port], other = next > port ? law->push[next] : ZERO;
    const num passed = law->passed[at_passed[joint]], on_left = ratio[port] * passed, on_right = ratio[next] * passed;
    for (int k = 0; k <= degree; ++k) {
        num sum = one * a[k] + other * b[k];
        if (NAME_FORCES > 0 && force >= 0 && k < 3) {
            sum += m->force[panel][force][k];
        }
        left[k] = on_left * sum - a[k];
        right[k] = on_right * sum - b[k];
    }
    OF(enlarge)(size, left);
    OF(enlarge)(size, right);
}

/* f = matrix * series, or f += where there is `more`, of `rows` times `columns` numbers. */
static void OF(add_series)(const num *matrix, int rows, int columns, num (*series)[NAME_ROW], int degree, int more,
                           num (*f)[NAME_ROW])
{
    for (int i = 0; i < rows; ++i) {
        OF(clear)(f[i], more ? 0 : degree + SPARE);
        for (int j = 0; j < columns; ++j) {
            OF(add)(f[i], &matrix[i * columns + j], series[j], degree);
        }
    }
}

/* The truncation error of a block: the one term of x' = rates x + f that does not fit, as velocities. What a spring misses
 * of its length counts by the acceleration that it makes, for half a panel. */
static void OF(add_missed)(const OF(laws) *law, int joint, int panel, int degree, num (*f)[NAME_ROW],
                           num (*x)[NAME_ROW], num *missed)
{
    const int n = states_of(joint);
    const num *const rates = law->rates + at_rates[joint];
    const real half = half_length[panel];
    for (int i = 0; i < n; ++i) {
        num rest = f[i][degree];
        num weight = ZERO + 1;
        for (int j = 0; j < n; ++j) {
            const num pull = half * rates[j * n + i];
            rest += rates[i * n + j] * x[j][degree];
            if (!is_mass[first_state[joint] + i]) {
                OF(enlarge)(&weight, &pull);
            }
        }
        rest = weight * rest * (half / (real)(2 * (degree + 1)));
        OF(add_magnitude)(missed, &rest);
    }
}

/* Any joint that is no body. */
static BY_ITSELF void OF(march_joint)(OF(march_state) *m, OF(march_tables) *table, const OF(laws) *law, int joint, int panel,
                                      const places *now, int degree, const OF(forcing) *by, num *size, num *missed)
{
    num s[NAME_WIDEST][NAME_ROW], f[NAME_WIDEST][NAME_ROW], q[NAME_WIDEST][NAME_ROW];
    const int n = states_of(joint), points = points_of(joint), first = first_state[joint];
    const int forced = by && by->changed[joint];
    const num one = ZERO + 1;
    num(*const x)[NAME_ROW] = m->path[panel] + first;
    OF(gather)(m, law, by, joint, panel, now, degree, 0, s);
    OF(add_series)(law->passed + at_passed[joint], points, points, s, degree, 0, q);
    if (is_block(joint)) {
        OF(add_series)(law->pushed + at_pushed[joint], n, points, s, degree, 0, f);
        for (int i = 0; i < n && forced; ++i) {
            OF(add)(f[i], &one, by->moving[panel][first + i], degree);
        }
        OF(block_tables) block;
        OF(locate_block)(table, joint, panel, &block);
        OF(solve_block)(&block, half_length[panel], degree, f, m->state[1] + first, x);
        for (int i = 0; i < n; ++i) {
            OF(clear)(x[i] + degree + 1, SPARE - 1);
        }
        OF(add_missed)(law, joint, panel, degree, f, x, missed);
        OF(add_series)(law->shown + at_shown[joint], points, n, x, degree, 1, q);
    }
    for (int point = 0; point < points && forced; ++point) {
        OF(add)(q[point], &one, by->shifted[panel][first_point[joint] + point], degree);
    }
    OF(send_back)(m, joint, panel, now, degree, 0, q, size);
    for (int i = first; i < first + n; ++i) {
        if (is_mass[i]) {
            OF(enlarge)(size, &m->state[1][i]);
        }
    }
}

/* One window of some sets at a degree, or of derivatives under a forcing. To `missed` are added truncation errors; `size`
 * grows to the largest velocity or mean of a wave. */
static void OF(march)(OF(march_state) *all, OF(march_tables) *tables, const OF(laws) *law, int sets, int window, int degree,
                      const OF(forcing) *by, num *size, num *missed)
{
    places now;
    locate(window, &now);
    for (int set = 0; set < sets; ++set) {
        for (int k = 0; k < NAME_STATES; ++k) {
            all[set].state[1][k] = all[set].state[0][k];
        }
    }
    for (int panel = 0; panel < NAME_PANELS; ++panel) {
        OF(march_bodies)(all, tables, law, sets, panel, &now, degree, by, size, missed);
        for (int joint = 0; joint < NAME_JOINTS; ++joint) {
            const int is_point = points_of(joint) == 1 && states_of(joint) < 1 && !(by && by->changed[joint]) &&
                                 first_port[joint + 1] - first_port[joint] <= 2;
            for (int set = 0; set < sets && !is_body[joint]; ++set) {
                if (is_point) {
                    OF(scatter)(all + set, law + set, joint, panel, &now, degree, size + set);
                } else {
                    OF(march_joint)(all + set, tables + set, law + set, joint, panel, &now, degree, by, size + set,
                                    missed + set);
                }
            }
        }
    }
}
