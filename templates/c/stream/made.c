/* made.c: what parameters that come at run time make of the tables of a stream.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#define NAME_RUNTIME
#include "stream.c"

enum { SQUARE = MOST_MOVED * MOST_MOVED };

/* A joint on a panel, x' = rates x + f as series: x_k = y_k - down_k x_(k-1), y_k = solve_k r_k + down_k y_(k+1) with
 * r_k = f_(k-1) - f_(k+1), where x_0 and f_0 count twice; and 2 x_0 = start (x at the start - what the rest makes there).
 * Matrices have MOST_MOVED rows, those that a joint does not need of 0. */
typedef struct {
    real solve[SIZE][SQUARE];
    real down[SIZE + 1][SQUARE];
    real start[SQUARE];
} elimination;

typedef real motion[MOST_MOVED];

/* b = a^-1 b; a is lost. Where there is no such b it is no number. */
static void divide(real *b, real *a)
{
    enum { N = MOST_MOVED };
    for (int k = 0; k < N; ++k) {
        int best = k;
        for (int i = k + 1; i < N; ++i) {
            best = absolute(a[i * N + k]) > absolute(a[best * N + k]) ? i : best;
        }
        for (int j = 0; j < N; ++j) {
            const real of_a = a[k * N + j], of_b = b[k * N + j];
            a[k * N + j] = a[best * N + j];
            b[k * N + j] = b[best * N + j];
            a[best * N + j] = of_a;
            b[best * N + j] = of_b;
        }
        for (int i = 0; i < N; ++i) {
            const real factor = i == k ? (real)0 : a[i * N + k] / a[k * N + k];
            add(a + i * N, -factor, a + k * N, N);
            add(b + i * N, -factor, b + k * N, N);
        }
    }
    for (int k = 0; k < SQUARE; ++k) {
        b[k] /= a[k / N * (N + 1)];
    }
}

/* c += factor a b */
static void add_product(real *c, real factor, const real *a, const real *b)
{
    for (int k = 0; k < SQUARE; ++k) {
        add(c + k / MOST_MOVED * MOST_MOVED, factor * a[k], b + k % MOST_MOVED * MOST_MOVED, MOST_MOVED);
    }
}

static void set_square(real *a, real diagonal)
{
    for (int k = 0; k < SQUARE; ++k) {
        a[k] = k % (MOST_MOVED + 1) == 0 ? diagonal : (real)0;
    }
}

static void eliminate(elimination *by, const real *rates)
{
    real follows[SQUARE];
    real turned[SQUARE];
    set_square(by->down[SIZE], 0);
    for (int k = DEGREE; k > 0; --k) {
        const real step = panel / (real)(4 * k);
        real left[SQUARE];
        set_square(left, 1);
        add_product(left, -step, rates, by->down[k + 1]);
        set_square(follows, 0);
        add(follows, 1, left, SQUARE);
        set_square(by->solve[k], step);
        divide(by->solve[k], left);
        set_square(by->down[k], 0);
        add(by->down[k], -step, rates, SQUARE);
        divide(by->down[k], follows);
    }
    /* x_k follows from 2 x_0 alone by so much */
    set_square(follows, 1);
    set_square(turned, (real)0.5);
    for (int k = 1; k < SIZE; ++k) {
        real next[SQUARE];
        set_square(next, 0);
        add_product(next, -1, by->down[k], follows);
        set_square(follows, 0);
        add(follows, 1, next, SQUARE);
        add(turned, k % 2 ? (real)-1 : (real)1, next, SQUARE);
    }
    set_square(by->start, 1);
    divide(by->start, turned);
}

/* The series of the states of a joint that are `begun` at the start, under f = pushed T_power. */
static void solve_panel(const elimination *by, const real *begun_at, const real *pushed, int power, motion *x)
{
    motion y[SIZE + 1] = {{0}};
    motion start;
    motion before;
    motion twice = {0};
    for (int k = DEGREE; k > 0; --k) {
        const real factor = power == k - 1 ? (k == 1 ? (real)2 : (real)1) : power == k + 1 ? (real)-1 : (real)0;
        for (int a = 0; a < MOST_MOVED; ++a) {
            before[a] = factor * pushed[a];
        }
        multiply(y[k], by->solve[k], before, MOST_MOVED, MOST_MOVED);
        multiply(y[k], by->down[k], y[k + 1], MOST_MOVED, MOST_MOVED);
    }
    for (int a = 0; a < MOST_MOVED; ++a) {
        start[a] = begun_at[a];
    }
    /* first with nothing for x_0, to see what is left for it; then with it */
    for (int turn = 0; turn < 2; ++turn) {
        for (int a = 0; a < MOST_MOVED; ++a) {
            x[0][a] = twice[a] / 2;
            before[a] = -twice[a];
        }
        for (int k = 1; k < SIZE; ++k) {
            for (int a = 0; a < MOST_MOVED; ++a) {
                x[k][a] = y[k][a];
            }
            multiply(x[k], by->down[k], before, MOST_MOVED, MOST_MOVED);
            for (int a = 0; a < MOST_MOVED; ++a) {
                before[a] = -x[k][a];
                start[a] += k % 2 ? x[k][a] : -x[k][a];
            }
        }
        if (turn == 0) {
            multiply(twice, by->start, start, MOST_MOVED, MOST_MOVED);
        }
    }
}

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

/* A block: a column of its matrix, and of what its polynomials miss, for each number that it is given: the
 * coefficients of what acts on its points, then x at the start. What is missed is the root of an energy. */
static void tabulate_block(stream *state, int joint)
{
    const int points = first_point[joint + 1] - first_point[joint];
    const int states = first_state[joint + 1] - first_state[joint];
    const int width = points * SIZE + states;
    const name_made *const made = &state->made;
    const real *const own = made->rates + at_rates[joint];
    const real *const pushed = made->pushed + at_pushed[joint];
    const real *const shown = made->shown + at_shown[joint];
    const real *const passed = made->passed + at_passed[joint];
    const real turned = speed_of(made, joint, 0) * panel;
    const real energy = 2 * (root(turned) + (1 + turned) * (real)0.70711) * (panel / (real)(4 * SIZE));
    real rates[SQUARE] = {0};
    elimination by;
    for (int k = 0; k < states * states; ++k) {
        rates[k / states * MOST_MOVED + k % states] = own[k];
    }
    eliminate(&by, rates);
    for (int column = 0; column < width; ++column) {
        const int point = column < points * SIZE ? column / SIZE : -1;
        const int power = column % SIZE;
        real *const to = matrix + answer[joint] + column * width;
        motion x[SIZE];
        motion begun_at = {0};
        motion acting = {0};
        motion left = {0};
        for (int a = 0; a < states; ++a) {
            begun_at[a] = column == points * SIZE + a ? (real)1 : (real)0;
            acting[a] = point >= 0 ? pushed[a * points + point] : (real)0;
        }
        solve_panel(&by, begun_at, acting, point >= 0 ? power : -2, x);
        for (int p = 0; p < points; ++p) {
            for (int k = 0; k < SIZE; ++k) {
                to[p * SIZE + k] = point >= 0 && k == power ? passed[p * points + point] : (real)0;
                multiply(to + p * SIZE + k, shown + p * states, x[k], 1, states);
            }
        }
        /* of a polynomial the end less the start is in what is odd: nothing large is lost */
        for (int a = 0; a < states; ++a) {
            to[points * SIZE + a] = 0;
            for (int k = 1; k < SIZE; k += 2) {
                to[points * SIZE + a] += 2 * x[k][a];
            }
            left[a] = point >= 0 && power == DEGREE ? acting[a] : (real)0;
        }
        multiply(left, rates, x[DEGREE], MOST_MOVED, MOST_MOVED);
        for (int a = 0; a < states; ++a) {
            slip[first_slip[joint] + a * width + column] = energy * root(made->weight[first_state[joint] + a]) * left[a];
        }
    }
}

/* A body: slack and ratios, loss and first, 0 and last, of q_k + x_k (q_(k-1) - q_(k+1)) = x_k (p_(k-1) - p_(k+1)). */
static void tabulate_body(stream *state, int joint)
{
    const name_made *const made = &state->made;
    const real rate = -made->rates[at_rates[joint]];
    const real step = rate * panel;
    const real energy = 2 * (root(step) + (1 + step) * (real)0.70711) * root(made->weight[first_state[joint]]);
    real *const rows = matrix + answer[joint];
    real above = 0;
    real first = 0;
    real last = 0;
    for (int k = DEGREE; k > 0; --k) {
        const real ratio_of = step / ((real)(4 * k) + step * above);
        first = (real)(k % 2 ? -1 : 1) - above * first;
        last = 1 - above * last;
        above = ratio_of;
        rows[k] = ratio_of;
        rows[SIZE + k] = first;
        rows[2 * SIZE + k] = last;
    }
    rows[0] = -2 * above * first / (1 - 2 * above * first);
    rows[SIZE] = 2 * above * last;
    rows[2 * SIZE] = 0;
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
        energy += is_mass[first + b] ? state->made.weight[first + b] / 2 : (real)0;
        for (int a = 0; law[joint] == BLOCK && a < states; ++a) {
            sum += is_mass[first + b] ? absolute(missed[a * width + points * SIZE + b]) : (real)0;
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

/* What an error of each track counts for: those of rods times the root of the impedance. The velocity of a point follows
 * from what a rod there carries; that of one without rods from the state, and from what arrives at other points. */
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
        if (slots[send[port]] > 1) {
            root_impedance[send[port]] = root(made->track_impedance[send[port]]);
        } else {
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
    for (int joint = 0; joint < JOINTS; ++joint) {
        const real speed = speed_of(&state->made, joint, 0);
        fastest = speed <= fastest ? fastest : speed;
        if (law[joint] == BODY) {
            tabulate_body(state, joint);
        } else if (law[joint] == BLOCK) {
            tabulate_block(state, joint);
            fine &= speed_of(&state->made, joint, 1) * panel <= (real)CALM;
        } else {
            tabulate_scatterer(state, joint);
        }
        fine &= step_lost(state, joint) <= tolerance;
        weigh_tracks(state, joint);
    }
    for (int k = 0; k < HEARD; ++k) {
        if (shown_force[k] >= 0) {
            root_impedance[track[k]] = 0;
        }
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
        for (int k = 0; k < HEARD; ++k) {
            gain[k] = not_a_number();
        }
    }
    name_init(state);
    return status;
}
