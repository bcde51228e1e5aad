/* peaks.c: extremes under the scene's loads, between samples, too. */
#include "read.c"

/* What is known of the extremes of all outputs: side 0 the least, 1 the greatest. `best` is times -1 or 1, by points of
 * steps; `bend` is how far an output bends in a step. */
typedef struct {
    real best[OUTPUTS][2];
    int step[OUTPUTS][2];
    real when[OUTPUTS][2];
    real bend[OUTPUTS];
} extremes;

static real sign_of(int side)
{
    return side ? 1 : -1;
}

/* One output. */
static real read_one(const model *m, const motion *s, int output)
{
    real sum = 0;
    for (int j = 0; j < LOADS; ++j) {
        sum += m->direct[j][0][output] * s->load[j];
        sum += SUMS ? m->direct[j][1][output] * s->once[j] + m->direct[j][2][output] * s->twice[j] : 0;
    }
    for (int n = 0; n < MODES; ++n) {
        sum += m->moved[n][output] * s->y[n];
        sum += MOVING ? m->moving[n][output] * s->v[n] : 0;
    }
    return sum;
}

/* One output at equally spaced instants of a step, which are `inside`: whether it is higher there than ever before. */
static void look(const model *m, const motion *inside, real apart, int step, int output, int side, extremes *found)
{
    real value[POINTS];
    for (int k = 0; k < POINTS; ++k) {
        value[k] = sign_of(side) * read_one(m, &inside[k], output);
    }
    for (int k = 0; k < POINTS; ++k) {
        const int ends = k == 0 || k == POINTS - 1;
        const real change = ends ? 0 : value[k + 1] - value[k - 1];
        const real bend = ends ? 0 : 2 * value[k] - value[k - 1] - value[k + 1];
        const int is_top = bend > 0 && fabs(change) <= 2 * bend; /* of a parabola, within a point of the middle one */
        const real top = value[k] + (is_top ? change * change / (8 * bend) : 0);
        if (top > found->best[output][side]) {
            found->best[output][side] = top;
            found->step[output][side] = step;
            found->when[output][side] = (k + (is_top ? change / (2 * bend) : 0)) * apart;
        }
    }
}

/* How modes move in a step of this length that begins at `s`, at equally spaced instants. */
static void spread(const model *m, const turns *at, real length, int step, const motion *s, motion *inside)
{
    real slope[LOADS];
    slopes_after(m, step, slope);
    for (int k = 0; k < POINTS; ++k) {
        advance(m, &at[k], length * k / (POINTS - 1), slope, s, &inside[k]);
    }
}

static void turns_within(const model *m, real length, turns *at)
{
    for (int k = 0; k < POINTS; ++k) {
        turns_of(m->frequency, m->damping, length * k / (POINTS - 1), &at[k]);
    }
}

/* The largest of what an output is, times a sign, at the start, in the middle and at the end of a step. */
static real highest(real (*values)[FILLED], int step, int output, real sign)
{
    const real start = sign * values[2 * step][output];
    return most_of(start, most_of(sign * values[2 * step + 1][output], sign * values[2 * step + 2][output]));
}

/* Look at the steps of a block that may have extremes. */
static void search_block(
    const model *m, const turns *at, const motion *begin, real (*values)[FILLED], int first, int steps, extremes *found)
{
    motion inside[POINTS];
    for (int output = 0; output < OUTPUTS; ++output) {
        for (int k = 0; k < steps; ++k) {
            const real bend =
                fabs(values[2 * k][output] - 2 * values[2 * k + 1][output] + values[2 * k + 2][output]);
            found->bend[output] = most_of(found->bend[output], bend);
        }
    }
    int open[OUTPUTS][2];
    real limit[OUTPUTS][2];
    for (int output = 0; output < OUTPUTS; ++output) {
        for (int side = 0; side < 2; ++side) {
            real top = 0;
            for (int k = 0; k < steps; ++k) {
                top = most_of(top, highest(values, k, output, sign_of(side)));
            }
            /* twice as far as a parabola may rise above its samples */
            limit[output][side] = most_of(top, found->best[output][side]) - found->bend[output] / 4;
            open[output][side] = top > 0 && top >= limit[output][side];
        }
    }
    for (int k = 0; k < steps; ++k) {
        int made = 0;
        for (int output = 0; output < OUTPUTS; ++output) {
            for (int side = 0; side < 2; ++side) {
                if (open[output][side] && highest(values, k, output, sign_of(side)) >= limit[output][side]) {
                    if (!made) {
                        spread(m, at, spacing, first + k, &begin[k], inside);
                        made = 1;
                    }
                    look(m, inside, spacing / (POINTS - 1), first + k, output, side, found);
                }
            }
        }
    }
}

/* The last step, which the horizon ends: looked at by itself. */
static void search_last(const model *m, const motion *s, int step, extremes *found)
{
    const real length = tau_max - step * spacing;
    turns at[POINTS];
    motion inside[POINTS];
    if (!(length > 1e-9 * spacing)) {
        return;
    }
    turns_within(m, length, at);
    spread(m, at, length, step, s, inside);
    for (int output = 0; output < OUTPUTS; ++output) {
        for (int side = 0; side < 2; ++side) {
            look(m, inside, length / (POINTS - 1), step, output, side, found);
        }
    }
}

/* An output and its first two derivatives, while loads go by `slope`. */
static BY_ITSELF void read_derivatives(const model *m, const motion *s, const real *slope, int output, real *out)
{
    out[0] = read_one(m, s, output);
    out[1] = 0;
    out[2] = 0;
    for (int j = 0; j < LOADS; ++j) {
        out[1] += m->direct[j][0][output] * slope[j] + m->direct[j][1][output] * s->load[j];
        out[1] += m->direct[j][2][output] * s->once[j];
        out[2] += m->direct[j][1][output] * slope[j] + m->direct[j][2][output] * s->load[j];
    }
    for (int n = 0; n < MODES; ++n) {
        const real w = m->frequency[n];
        const real lost = 2 * m->damping[n] * w;
        real second = -lost * s->v[n] - w * w * s->y[n];
        for (int j = 0; j < LOADS; ++j) {
            second += m->push[j][n] * s->load[j];
        }
        real third = -lost * second - w * w * s->v[n];
        for (int j = 0; j < LOADS; ++j) {
            third += m->push[j][n] * slope[j];
        }
        out[1] += m->moved[n][output] * s->v[n] + m->moving[n][output] * second;
        out[2] += m->moved[n][output] * second + m->moving[n][output] * third;
    }
}

/* The top near an instant of a step that begins at `s`, by its value there and its derivatives: Newton's method. */
static void refine(const model *m, const motion *s, const real *slope, int output, int side, extremes *found)
{
    const real length = least_of(spacing, tau_max - found->step[output][side] * spacing);
    real when = least_of(most_of(found->when[output][side], 0), length);
    for (int times = 0; times < 2; ++times) {
        turns t;
        motion then;
        real value[3];
        turns_of(m->frequency, m->damping, when, &t);
        advance(m, &t, when, slope, s, &then);
        read_derivatives(m, &then, slope, output, value);
        const real shift = sign_of(side) * value[2] < 0 ? -value[1] / value[2] : 0;
        const real top = when + shift;
        const int inside = fabs(shift) <= length / (POINTS - 1) && top >= 0 && top <= length;
        found->best[output][side] = sign_of(side) * (inside ? value[0] + value[1] * shift / 2 : value[0]);
        when = inside ? top : when;
    }
    found->when[output][side] = when;
}

static void search(const model *m, extremes *found)
{
    const int steps = HALVES / 2;
    turns at[POINTS];
    motion begin[BLOCK + 1];
    real values[2 * BLOCK + 1][FILLED];
    turns_within(m, spacing, at);
    rest(&begin[0]);
    read_motion(m, &begin[0], values[0]);
    for (int first = 0; first < steps; first += BLOCK) {
        const int count = steps - first < BLOCK ? steps - first : BLOCK;
        step_block(m, first, 2 * count, begin, values + 1);
        search_block(m, at, begin, values, first, count, found);
        begin[0] = begin[count];
        for (int output = 0; output < FILLED; ++output) {
            values[0][output] = values[2 * count][output];
        }
    }
    search_last(m, &begin[0], steps, found);
}

/* The tops, each computed where it is, in one pass. */
static void refine_all(const model *m, extremes *found)
{
    motion s;
    real slope[LOADS];
    rest(&s);
    for (int step = 0; step <= HALVES / 2; ++step) {
        slopes_after(m, step, slope);
        for (int output = 0; output < OUTPUTS; ++output) {
            for (int side = 0; side < 2; ++side) {
                if (found->step[output][side] == step) {
                    refine(m, &s, slope, output, side, found);
                }
            }
        }
        advance(m, &m->half, spacing / 2, slope, &s, &s);
        advance(m, &m->half, spacing / 2, slope, &s, &s);
    }
}

/* The least and the greatest value of each output, each with its tau. */
static void find_peaks(const model *m, real *out)
{
    extremes found;
    for (int output = 0; output < OUTPUTS; ++output) {
        found.bend[output] = 0;
        for (int side = 0; side < 2; ++side) {
            found.best[output][side] = 0;
            found.step[output][side] = -1;
            found.when[output][side] = 0;
        }
    }
    search(m, &found);
    refine_all(m, &found);
    for (int output = 0; output < OUTPUTS; ++output) {
        for (int side = 0; side < 2; ++side) {
            const int rests = found.step[output][side] < 0; /* and never leaves 0 on this side */
            out[4 * output + 2 * side] = rests ? 0 : sign_of(side) * found.best[output][side];
            out[4 * output + 2 * side + 1] = rests ? 0 : found.step[output][side] * spacing + found.when[output][side];
        }
    }
}

int name_model_peaks(const model *m, real *out)
{
    if (m->status != 1) {
        find_peaks(m, out);
        return 0;
    }
    for (int k = 0; k < 4 * OUTPUTS; ++k) {
        out[k] = not_a_number();
    }
    return 1;
}
