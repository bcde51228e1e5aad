/* peaks.c: the least and the greatest value of each output of a model, between samples, too. */
#include "blocks.c"

/* How often an interval is halved at most; into how many parts one is cut where it is looked at closely;
 * how many sums are taken side by side. */
enum { DEEPEST = 60, CLOSELY = 8, SUMS = 4 };

/* The greatest value of an output, or of its negative where `sign` is -1, of all that were seen, and when. */
typedef struct {
    real sign, best, tau;
} summit;

static void seen(summit *top, real value_there, real tau)
{
    if (top->sign * value_there > top->best) {
        top->best = top->sign * value_there;
        top->tau = tau;
    }
}

/* At most so large is the second derivative of an output on a section of a window: |T_k''| <= k^2 (k^2 - 1) / 3. What is
 * no more than `noise` in a series is not counted: it cannot matter, and its highest degrees would. */
static real bend(const name_model *m, int window, int at, real noise)
{
    const int degree = m->degree[window];
    real sum = 0;
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        const int s = strand_at[k];
        const real *const c = m->series + m->place[window] + (size_t)s * (size_t)(degree + 2);
        real here = 0;
        for (int n = 2; n <= degree + 1; ++n) {
            const real square = (real)n * (real)n;
            here += magnitude(c[n]) > noise ? magnitude(c[n]) * (square * (square - 1)) : (real)0;
        }
        sum += here * (strand_scale[s] * strand_scale[s] / 3);
    }
    return sum;
}

/* An output on the part of a window where it is one polynomial. */
typedef struct {
    const name_model *m;
    int window, section, output;
    real begin, length, bend;
} part;

/* An interval from `left` on whose ends are no higher than h rises to h + bend * width^2 / 8 at most. Halve until that
 * is no more than `slack` above the best; `end` is a stack of the ends of intervals that follow each other. */
static void climb(const part *p, summit *top, real left, real at_left, real right, real at_right, real slack)
{
    real end[DEEPEST], at_end[DEEPEST];
    int last = 0;
    end[0] = right;
    at_end[0] = top->sign * at_right;
    at_left *= top->sign;
    while (last >= 0) {
        const real width = end[last] - left;
        const real higher = at_left > at_end[last] ? at_left : at_end[last];
        if (last < DEEPEST - 1 && higher + p->bend * width * width / 8 > top->best + slack) {
            const real middle = left + width / 2;
            const int at = p->section * NAME_OUTPUTS + p->output;
            real found;
            value(p->m->series + p->m->place[p->window], p->window, p->m->degree[p->window], at, middle, &found);
            seen(top, found, cycle_begin(p->window) + middle);
            ++last;
            end[last] = middle;
            at_end[last] = top->sign * found;
        } else {
            left = end[last];
            at_left = at_end[last];
            --last;
        }
    }
}

/* A part at BLOCK instants, its ends included. */
static BY_ITSELF void survey(const part *p, real *t, real *found)
{
    for (int j = 0; j < BLOCK; ++j) {
        t[j] = p->begin + p->length * (offset[j] / (BLOCK - 1));
    }
    output_block(p->m, p->window, p->section * NAME_OUTPUTS + p->output, t, found);
}

/* As bend, of what was found in a survey: four times the largest second difference. Near a front, or where an output
 * comes to rest, the bound of a whole panel is far too large. */
static real bend_seen(const part *p, const real *found)
{
    const real step = p->length / (BLOCK - 1);
    real most = 0;
    for (int j = 1; j + 1 < BLOCK; ++j) {
        most = larger(most, (found[j - 1] - found[j]) + (found[j + 1] - found[j]));
    }
    const real seen_here = 4 * most / (step * step);
    return seen_here < p->bend ? seen_here : p->bend;
}

/* Look for what is higher between two instants, where it can be. */
static void explore(const part *p, summit *top, real left, real at_left, real right, real at_right, real slack)
{
    const real width = right - left;
    const real one = top->sign * at_left, other = top->sign * at_right;
    if (!((one > other ? one : other) + p->bend * width * width / 8 > top->best + slack)) {
        return;
    }
    for (int i = 0; i < CLOSELY; ++i) {
        real t[BLOCK], found[BLOCK];
        part q = *p;
        q.begin = left + width * ((real)i / (real)CLOSELY);
        q.length = width / (real)CLOSELY;
        survey(&q, t, found);
        q.bend = bend_seen(&q, found);
        for (int j = 0; j < BLOCK; ++j) {
            seen(top, found[j], cycle_begin(p->window) + t[j]);
        }
        for (int j = 1; j < BLOCK; ++j) {
            climb(&q, top, t[j - 1], found[j - 1], t[j], found[j], slack);
        }
    }
}

/* Whether an output may be beyond what was seen of it, on a section of a window: a sum of c_k T_k is no further from c_0
 * than the sum of the other |c_k|, and what rounding adds to that. */
static int beyond(const name_model *m, int window, int at, const summit *least, const summit *greatest)
{
    const int degree = m->degree[window];
    real middle = 0, around = 0, sums[SUMS] = {0}; /* a sum alone would wait for each of its terms */
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        const real *const c = m->series + m->place[window] + (size_t)strand_at[k] * (size_t)(degree + 2);
        int n = 1;
        middle += c[0];
        for (; n + SUMS <= degree + 2; n += SUMS) {
            UNROLLED
            for (int j = 0; j < SUMS; ++j) {
                sums[j] += magnitude(c[n + j]);
            }
        }
        for (; n < degree + 2; ++n) {
            sums[0] += magnitude(c[n]);
        }
    }
    for (int j = 0; j < SUMS; ++j) {
        around += sums[j];
    }
    around += 256 * unit * (magnitude(middle) + around);
    return !(middle + around <= greatest->best && around - middle <= least->best);
}

/* First the best of all instants surveyed; then, `slack` given, of all between them that may be higher. */
static void search(const name_model *m, int output, summit *least, summit *greatest, const real *slack)
{
    for (int window = 0; window < NAME_WINDOWS; ++window) {
        for (int section = 0; section < SECTIONS; ++section) {
            real t[BLOCK], found[BLOCK];
            const real begin = from[in_cycle(window, section)];
            part p = {m, window, section, output, begin, section_end(window, section) - begin, 0};
            if (p.length < 0 || !beyond(m, window, section * NAME_OUTPUTS + output, least, greatest)) {
                continue;
            }
            survey(&p, t, found);
            if (slack) {
                p.bend = bend(m, window, section * NAME_OUTPUTS + output, *slack);
            }
            if (!finite_number(p.bend)) {
                continue; /* numbers so near the largest one that their sums are beyond it */
            }
            for (int j = 0; j < BLOCK; ++j) {
                if (!slack) {
                    seen(least, found[j], cycle_begin(window) + t[j]);
                    seen(greatest, found[j], cycle_begin(window) + t[j]);
                } else if (j > 0) {
                    explore(&p, greatest, t[j - 1], found[j - 1], t[j], found[j], *slack);
                    explore(&p, least, t[j - 1], found[j - 1], t[j], found[j], *slack);
                }
            }
        }
    }
}

/* The peaks of one output. */
static BY_ITSELF void find_peaks(const name_model *m, int output, real *out)
{
    summit least = {-1, -largest_number, not_a_number()};
    summit greatest = {1, -largest_number, not_a_number()};
    if (m->built) {
        search(m, output, &least, &greatest, NULL);
        const real slack = 4 * unit * larger(magnitude(least.best), greatest.best);
        search(m, output, &least, &greatest, &slack);
    }
    out[0] = m->built ? -least.best : not_a_number();
    out[1] = least.tau;
    out[2] = m->built ? greatest.best : not_a_number();
    out[3] = greatest.tau;
}

int name_model_peaks(const name_model *model, name_real *out)
{
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        find_peaks(model, output, out + output * 4);
    }
    return !model->built;
}
