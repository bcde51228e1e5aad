/* joint.c: a joint on a panel, as marches and streams step it: from the waves that arrive at its ends and what acts on its
 * points those that it sends. */
#ifndef TABLES
#include "march/tables.h"
#include "series.h"
#endif

/* A joint on a panel: its matrix there, what waves that arrive at its ends push with and how strong loads are, the waves
 * that arrive, and where those go that it sends. */
typedef struct {
    const real *table;
    const real *pushes;
    real driven;
    const real *arriving[MOST_PORTS];
    real *sent[MOST_PORTS];
} joint_on_panel;

static const joint_on_panel no_ends = {NULL, NULL, 0, {NULL}, {NULL}};

/* A joint without state: what it sends is a sum of what arrives and acts. */
static void scatter(int joint, const joint_on_panel *on, const real *acting)
{
    const real *factor = on->table;
    const int ports = first_port[joint + 1] - first_port[joint];
    for (int port = 0; port < ports; ++port) {
        clear(on->sent[port], SIZE);
    }
    for (int port = 0; port < ports; ++port) {
        for (int other = 0; other < ports; ++other) {
            add(on->sent[other], *factor++, on->arriving[port], SIZE);
        }
    }
    for (int point = first_point[joint]; point < first_point[joint + 1]; ++point) {
        for (int other = 0; other < ports; ++other) {
            if (acting && force_on[point] >= 0) {
                add(on->sent[other], *factor, acting + force_on[point] * POWERS, POWERS);
            }
            ++factor;
        }
    }
}

/* The numbers of a body for each degree, k > 0: y_k = RATIO (p_(k-1) - p_(k+1) + y_(k+1)), with p_0 twice, q_k = y_k -
 * RATIO q_(k-1); FIRST and LAST sum to the velocity at both ends. At k = 0 what q_0 has less, and what the end has. */
enum { RATIO = 0, SUM_FIRST = 1, SUM_LAST = 2, SLACK = 0, LOSS = 1 };

/* A body: its velocity q from p, with p[SIZE] = 0, and from what it is at the start; gives what it is at the end. */
static real step_body(const real *rows, const real *p, real initial, real *q)
{
    real y = 0;
    real first_sum = 0;
    real last_sum = 0;
    for (int k = DEGREE; k > 0; --k) {
        y = rows[3 * k + RATIO] * (((k == 1 ? 2 * p[0] : p[k - 1]) - p[k + 1]) + y);
        q[k] = y;
        first_sum += rows[3 * k + SUM_FIRST] * y;
        last_sum += rows[3 * k + SUM_LAST] * y;
    }
    first_sum = initial - first_sum;
    q[0] = first_sum - rows[SLACK] * first_sum;
    real before = 2 * q[0];
    for (int k = 1; k <= DEGREE; ++k) {
        before = q[k] - rows[3 * k + RATIO] * before;
        q[k] = before;
    }
    return q[0] + (last_sum - rows[LOSS] * q[0]);
}

/* A block: velocities of its points, followed by x at the end less x, from `count` numbers that act on its points, and x. */
static void step_block(const real *columns, const real *acting, int count, const real *x, int states, real *velocities)
{
    const int width = count + states;
    clear(velocities, width);
    for (int k = 0; k < count; ++k) {
        if (!(acting[k] == 0)) { /* as where loads alone act */
            add(velocities, acting[k], columns + k * width, width);
        }
    }
    for (int k = 0; k < states; ++k) {
        add(velocities, x[k], columns + (count + k) * width, width);
    }
}

/* A joint under forces (coefficients of each, NULL for none), whose states x go from the start of the panel to its end.
 * Where it has states `given` becomes what acts on its points, with p for a body, and then the `velocities` of these
 * points follow. */
static BY_ITSELF void step_joint(int joint, const joint_on_panel *on, const real *acting, real *x, real *given,
                                 real *velocities)
{
    const int body = BODIES > 0 && law[joint] == BODY;
    const int first = first_port[joint];
    const int points = first_point[joint + 1] - first_point[joint];
    const int states = first_state[joint + 1] - first_state[joint];
    if (states < 1) {
        scatter(joint, on, acting);
        return;
    }
    if (body) {
        for (int k = 0; k < SIZE; ++k) {
            given[k] = on->pushes[0] * on->arriving[0][k];
        }
    } else {
        clear(given, points * SIZE);
    }
    for (int port = first + body; port < first_port[joint + 1]; ++port) {
        add(given + point_of[port] * SIZE, on->pushes[port - first], on->arriving[port - first], SIZE);
    }
    for (int point = 0; acting && point < points; ++point) {
        const int force = force_on[first_point[joint] + point];
        if (force >= 0) {
            add(given + point * SIZE, body ? on->driven : (real)1, acting + force * POWERS, POWERS);
        }
    }
    if (body) {
        given[SIZE] = 0;
        *x = step_body(on->table, given, *x, velocities);
    } else if (BLOCKS > 0) {
        const int count = points * SIZE;
        step_block(on->table, given, count, x, states, velocities);
        for (int k = 0; k < states; ++k) {
            given[count + k] = x[k];
            x[k] += velocities[count + k];
        }
    }
    for (int port = first; port < first_port[joint + 1]; ++port) {
        const real *const a = on->arriving[port - first];
        const real *const q = velocities + point_of[port] * SIZE;
        real *const out = on->sent[port - first];
        for (int k = 0; k < SIZE; ++k) {
            out[k] = ratio[port] * q[k] - a[k];
        }
    }
}
