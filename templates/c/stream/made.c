/* made.c: what parameters that come at run time make of the tables of a stream. */
#define NAME_RUNTIME
#include "stream.c"
#include "../elimination.c"

/* How fast anything in a joint is, at most: the norm of its rates, scaled so that energy is |x|^2 / 2; or `turning`, of
 * what springs make of it alone. No number where that is beyond all bounds. */
static real speed_of(const name_made *made, int joint, int turning)
{
    const int first = first_state[joint];
    const int states = first_state[joint + 1] - first_state[joint];
    const real *const rates = made->rates + at_rates[joint];
    const real *const weight = made->weight + first;
    real rows = 0;
    real columns = 0;
    for (int a = 0; a < states; ++a) {
        real row = 0;
        real column = 0;
        for (int b = 0; b < states; ++b) {
            const real of = weight[a] / weight[b];
            const real scaled = of > 0 && is_number(of) ? root(of) : not_a_number();
            const real to = rates[a * states + b] * scaled;
            const real back = rates[b * states + a] / scaled;
            row += absolute(turning ? (to - back) / 2 : to);
            column += absolute(turning ? (to - back) / 2 : back);
        }
        rows = row <= rows ? rows : row;
        columns = column <= columns ? columns : column;
    }
    rows = rows * columns;
    return rows > 0 && is_number(rows) ? root(rows) : rows;
}

/* A block: a column of its matrix, and of what its polynomials miss, for each number that it is given: the coefficients of
 * what acts on its points, then x at the start. What is missed is the root of an energy. */
static void tabulate_matrix(stream *state, int joint)
{
    enum { SQUARE = MOST_STATES * MOST_STATES };
    const name_made *const made = &state->made;
    const int points = first_point[joint + 1] - first_point[joint];
    const int states = first_state[joint + 1] - first_state[joint];
    const int width = points * SIZE + states;
    const real *const own = made->rates + at_rates[joint];
    const real turned = speed_of(made, joint, 0) * panel;
    const real energy = 2 * (root(turned) + (1 + turned) * (real)0.70711) * (panel / (real)(4 * SIZE));
    real tables[4][(SIZE + 1) * SQUARE];
    real edges[2][SQUARE];
    const block_tables m = {states,    (size_t)(states * states), tables[0], tables[1],
                            tables[2], tables[3],                 edges[0],  edges[1]};
    tabulate_block(&m, own, panel / 2, DEGREE);
    for (int column = 0; column < width; ++column) {
        const int point = column < points * SIZE ? column / SIZE : -1;
        const int power = column % SIZE;
        real *const to = matrix + answer[joint] + column * width;
        real f[MOST_STATES][ROW] = {{0}};
        real x[MOST_STATES][ROW];
        real at_end[MOST_STATES] = {0};
        for (int a = 0; a < states; ++a) {
            at_end[a] = column == points * SIZE + a ? (real)1 : (real)0;
            f[a][power] = point >= 0 ? made->pushed[at_pushed[joint] + a * points + point] : (real)0;
        }
        solve_block(&m, panel / 2, DEGREE, f, at_end, x);
        for (int k = 0; k < points * SIZE; ++k) {
            const int other = k / SIZE;
            to[k] = point >= 0 && power == k % SIZE ? made->passed[at_passed[joint] + other * points + point] : (real)0;
            for (int a = 0; a < states; ++a) {
                to[k] += made->shown[at_shown[joint] + other * states + a] * x[a][k % SIZE];
            }
        }
        for (int a = 0; a < states; ++a) {
            real left = f[a][DEGREE];
            for (int b = 0; b < states; ++b) {
                left += own[a * states + b] * x[b][DEGREE];
            }
            slip[first_slip[joint] + a * width + column] = energy * root(made->weight[first_state[joint] + a]) * left;
            /* of a polynomial the end less the start is in what is odd: nothing large is lost */
            to[points * SIZE + a] = 0;
            for (int k = 1; k < SIZE; k += 2) {
                to[points * SIZE + a] += 2 * x[a][k];
            }
        }
    }
}

/* A body. */
static BY_ITSELF void tabulate_mass(stream *state, int joint)
{
    const name_made *const made = &state->made;
    const real rate = -made->rates[at_rates[joint]];
    const real step = rate * panel;
    const real energy = 2 * (root(step) + (1 + step) * (real)0.70711) * root(made->weight[first_state[joint]]);
    tabulate_body((real(*)[3])(matrix + answer[joint]), &rate, panel, DEGREE);
    drive[joint] = made->pushed[at_pushed[joint]] / rate;
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        push[port] *= drive[joint];
    }
    slip[first_slip[joint]] = energy * step / (real)(4 * SIZE);
}

/* One without: what goes back into each end, from what arrives at each, and from what acts on each point. */
static void tabulate_scatterer(stream *state, int joint)
{
    const int points = first_point[joint + 1] - first_point[joint];
    const real *const passed = state->made.passed + at_passed[joint];
    real *factor = matrix + answer[joint];
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        for (int other = first_port[joint]; other < first_port[joint + 1]; ++other) {
            const real moved = passed[point_of[other] * points + point_of[port]] * push[port];
            *factor++ = ratio[other] * moved - (other == port ? (real)1 : (real)0);
        }
    }
    for (int point = 0; point < points; ++point) {
        for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
            *factor++ = ratio[port] * passed[point_of[port] * points + point];
        }
    }
}

/* What part of the energy that comes polynomials lose at most where all waves and bodies, at rest so far, jump to 1: a
 * root. */
static real step_lost(const stream *state, int joint)
{
    const int points = first_point[joint + 1] - first_point[joint];
    const int first = first_state[joint];
    const int states = first_state[joint + 1] - first;
    const int width = points * SIZE + states;
    const real *const missed = slip + first_slip[joint];
    real p[SIZE + 1] = {0};
    real q[SIZE];
    real energy = 0;
    real sum = 0;
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        energy += panel * state->made.track_impedance[arrive[port]];
        p[0] += push[port];
        for (int a = 0; law[joint] == BLOCK && a < states; ++a) {
            sum += absolute(push[port] * missed[a * width + point_of[port] * SIZE]);
        }
    }
    for (int b = 0; b < states; ++b) {
        energy += moves_with[first + b] >= 0 ? state->made.weight[first + b] / 2 : (real)0;
        for (int a = 0; law[joint] == BLOCK && a < states; ++a) {
            sum += moves_with[first + b] >= 0 ? absolute(missed[a * width + points * SIZE + b]) : (real)0;
        }
    }
    if (law[joint] == BODY) {
        (void)step_body(matrix + answer[joint], p, 0, q);
        sum += missed[0] * absolute(q[DEGREE]);
        p[0] = 0;
        (void)step_body(matrix + answer[joint], p, 1, q);
        sum += missed[0] * absolute(q[DEGREE]);
    }
    return sum > 0 ? sum / root(energy) : sum;
}

/* What an error of each track without a rod counts for. The velocity of a point follows from what a rod there carries;
 * that of one without rods from the state, and from what arrives at other points. */
static void weigh_tracks(stream *state, int joint)
{
    const int points = first_point[joint + 1] - first_point[joint];
    const int states = first_state[joint + 1] - first_state[joint];
    const name_made *const made = &state->made;
    const real *const shown = made->shown + at_shown[joint];
    const real *const passed = made->passed + at_passed[joint];
    for (int port = first_port[joint]; port < first_port[joint + 1]; ++port) {
        const int point = point_of[port];
        real carried = 0;
        real moved = 0;
        real passing = 0;
        if (slots[send[port]] == 1) {
            for (int a = 0; a < states; ++a) {
                moved += (real)1.4143 * absolute(shown[point * states + a]) / root(made->weight[first_state[joint] + a]);
            }
            for (int other = first_port[joint]; other < first_port[joint + 1]; ++other) {
                const real strong = root(made->track_impedance[send[other]]);
                const real own = point_of[other] == point ? ratio[other] * strong / 2 : (real)0;
                carried = carried > own ? carried : own;
                passing += strong > 0 ? absolute(passed[point * points + point_of[other]] * push[other]) / strong : (real)0;
            }
            state_gain[send[port]] = carried > 0 ? (real)0 : moved;
            root_impedance[send[port]] = carried > 0 ? carried : 1 / (passing + (moved > 0 ? moved : (real)1));
        }
    }
}

/* All tables. 0; 1 for a bad number; 2 where polynomials would lose too much, or springs are too stiff for a panel. */
static int made_of(stream *state, const name_parameters *parameters)
{
    int fine = 1;
    real fastest = 0;
    if (!good(parameters)) {
        return 1;
    }
    laws_of(parameters, &state->made);
    if (!laws_within_reach(&state->made)) {
        return 1;
    }
    for (int k = 0; k < TRACKS; ++k) {
        root_impedance[k] = root(state->made.track_impedance[k]);
        state_gain[k] = 0;
    }
    for (int joint = 0; joint < JOINTS; ++joint) {
        const real speed = speed_of(&state->made, joint, 0);
        fastest = speed <= fastest ? fastest : speed;
        if (law[joint] == BODY) {
            tabulate_mass(state, joint);
        } else if (law[joint] == BLOCK) {
            tabulate_matrix(state, joint);
            fine &= speed_of(&state->made, joint, 1) * panel <= (real)CALM;
        } else {
            tabulate_scatterer(state, joint);
        }
        fine &= step_lost(state, joint) <= tolerance;
        weigh_tracks(state, joint);
    }
    for (int k = 0; k < TERMS; ++k) {
        if (shown_force[k] >= 0) {
            root_impedance[track[k]] = 0;
        }
        fine &= is_number(root_impedance[track[k]]) && is_number(state_gain[track[k]]);
    }
    growth = fastest * (root(2 * fastest * step_length) + 2);
    fine &= is_number(growth);
    return fine ? 0 : 2;
}

int name_build(stream *state, const name_parameters *parameters)
{
    const int status = made_of(state, parameters);
    if (status) {
        (void)made_of(state, &name_defaults);
        for (int k = 0; k < TERMS; ++k) {
            gain[k] = not_a_number();
        }
    }
    name_init(state);
    return status;
}
