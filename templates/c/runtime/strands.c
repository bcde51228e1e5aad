/* strands.c: what outputs hear of many sets of parameters, in lanes.
 * Plain C that stands below the text of a march in lanes in generated files, which have what stands below the first empty
 * line. */
#include "batch.c"

/* As integrate, of a wave of a part, and times half the length of the panel. */
static void integrate_batch(const real *inverse, const wide *w, int degree, real half, wide *c)
{
    c[0] = none;
    c[1] = half * (degree > 1 ? (wide)(w[0] - w[2] / 2) : w[0]);
    for (int k = 2; k < degree; ++k) {
        c[k] = (w[k - 1] - w[k + 1]) * (half * inverse[k]);
    }
    c[degree] = w[degree - 1] * (half * inverse[degree]);
    c[degree + 1] = w[degree] * (half * inverse[degree + 1]);
}

/* As end_value, of the sums of all parts. */
static void end_value_batch(const part_of *p, int degree, real u, wide *value)
{
    wide next[PARTS], after[PARTS];
    const int by = u < 0 || u > 0 ? 1 : 2;
    for (int side = 0; side < PARTS; ++side) {
        next[side] = after[side] = none;
    }
    if (u > -1 && u < 1 && by == 1) {
        for (int k = degree; k > 0; --k) {
            UNROLLED
            for (int side = 0; side < PARTS; ++side) {
                const wide now = (2 * u * next[side] - after[side]) + p[side].sum[k];
                after[side] = next[side];
                next[side] = now;
            }
        }
        for (int side = 0; side < PARTS; ++side) {
            value[side] = (u * next[side] - after[side]) + p[side].sum[0];
        }
        return;
    }
    for (int k = 0; k <= degree; k += 2 * by) {
        UNROLLED
        for (int side = 0; side < PARTS; ++side) {
            next[side] += p[side].sum[k];
            after[side] += k + by <= degree ? p[side].sum[k + by] : none;
        }
    }
    for (int side = 0; side < PARTS; ++side) {
        value[side] = u > 0 ? next[side] + after[side] : next[side] - after[side];
    }
}

/* How far the numbers of a part are from those of the one before. */
enum { NEXT = sizeof(part_of) / sizeof(wide) };

/* Add to a strand a term that is summed up: the integral of its wave. */
static void listen_on(part_of *p, const real *inverse, const laws_batch *law, int t, int window, int degree, wide *c)
{
    const int heard = term_heard[t];
    wide low[PARTS], high[PARTS];
    for (int side = 0; side < PARTS; ++side) {
        integrate_batch(inverse, sent_batch(p + side, t, window), degree, half_length[term_panel[t]], p[side].sum);
    }
    end_value_batch(p, degree + 1, term_low[t], low);
    end_value_batch(p, degree + 1, term_high[t], high);
    for (int side = 0; side < PARTS; ++side) {
        const wide gain = law[side].gain[heard];
        c[side] += gain * (p[side].total[heard] - low[side]);
        p[side].total[heard] += high[side] - low[side];
        for (int k = 1; k <= degree + 1; ++k) {
            c[k * PARTS + side] += gain * p[side].sum[k];
        }
    }
}

/* As listen, of a strand, and as weigh: two waves at once, where they are not summed up. */
static void strand_batch(part_of *p, const real *inverse, const laws_batch *law, int s, int window, int degree, wide *c,
                         wide *here)
{
    const int last = first_term[s + 1];
    int t = first_term[s];
    UNROLLED
    for (int side = 0; side < PARTS; ++side) {
        c[(degree + 1) * PARTS + side] = none;
        here[side] = none;
    }
    if (last - t == 2 && !term_summed[t] && !term_summed[t + 1]) {
        const wide *const w = sent_batch(p, t, window);
        const wide *const v = sent_batch(p, t + 1, window);
        wide one[PARTS], other[PARTS];
        UNROLLED
        for (int side = 0; side < PARTS; ++side) {
            one[side] = law[side].gain[term_heard[t]];
            other[side] = law[side].gain[term_heard[t + 1]];
        }
        for (int k = 0; k <= degree; ++k) {
            UNROLLED
            for (int side = 0; side < PARTS; ++side) {
                const wide sum = one[side] * w[side * NEXT + k] + other[side] * v[side * NEXT + k];
                c[k * PARTS + side] = sum;
                here[side] += MAGNITUDES(sum);
            }
        }
        return;
    }
    for (int k = 0; k < (degree + 1) * PARTS; ++k) {
        c[k] = none;
    }
    for (; t < last; ++t) {
        const wide *const w = sent_batch(p, t, window);
        if (term_summed[t]) {
            listen_on(p, inverse, law, t, window, degree, c);
            continue;
        }
        for (int side = 0; side < PARTS; ++side) {
            const wide gain = law[side].gain[term_heard[t]];
            for (int k = 0; k <= degree; ++k) {
                c[k * PARTS + side] += gain * w[side * NEXT + k];
            }
        }
    }
    for (int k = 0; k <= degree + 1; ++k) {
        UNROLLED
        for (int side = 0; side < PARTS; ++side) {
            here[side] += MAGNITUDES(c[k * PARTS + side]);
        }
    }
}

/* As listen, and as weigh. */
static void listen_batch(part_of *p, const real *inverse, const laws_batch *law, int window, int degree, wide *all,
                         wide *heard)
{
    wide weight[PARTS], here[PARTS];
    for (int side = 0; side < PARTS; ++side) {
        weight[side] = none;
    }
    for (int s = 0; s < NAME_STRANDS; ++s) {
        wide *const c = all + (size_t)s * (size_t)(degree + 2) * PARTS;
        strand_batch(p, inverse, law, s, window, degree, c, here);
        for (int side = 0; side < PARTS; ++side) {
            weight[side] += here[side];
        }
    }
    for (int side = 0; side < PARTS; ++side) {
        heard[side] += (real)(4 * (degree + 2)) * weight[side];
    }
}

/* As series_at, of all parts. */
static void series_at_batch(const wide *c, int degree, real u, wide *value)
{
    wide next[PARTS], after[PARTS];
    UNROLLED
    for (int side = 0; side < PARTS; ++side) {
        next[side] = after[side] = none;
    }
    for (int k = degree; k > 0; --k) {
        UNROLLED
        for (int side = 0; side < PARTS; ++side) {
            const wide now = (2 * u * next[side] - after[side]) + c[k * PARTS + side];
            after[side] = next[side];
            next[side] = now;
        }
    }
    UNROLLED
    for (int side = 0; side < PARTS; ++side) {
        value[side] += (u * next[side] - after[side]) + c[side];
    }
}

/* The means of an output on a section, and whether they make it worth a look in some set. */
static int mean_batch(const part_of *p, const wide *all, size_t size, int at, wide *mean)
{
    mask worth = NOWHERE;
    UNROLLED
    for (int side = 0; side < PARTS; ++side) {
        mean[side] = none;
    }
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        UNROLLED
        for (int side = 0; side < PARTS; ++side) {
            mean[side] += all[(size_t)strand_at[k] * size + (size_t)side];
        }
    }
    UNROLLED
    for (int side = 0; side < PARTS; ++side) {
        worth |= MAGNITUDES(mean[side]) > p[side].worth[at % NAME_OUTPUTS];
    }
    return in_some(&worth);
}

/* As look. */
static void look_batch(part_of *p, const wide *all, int window, int degree)
{
    const size_t size = (size_t)(degree + 2) * PARTS;
    for (int at = 0; at < SECTIONS * NAME_OUTPUTS; ++at) {
        const int output = at % NAME_OUTPUTS;
        const int here = in_cycle(window, at / NAME_OUTPUTS);
        const real reach = NAME_TAU_MAX - cycle_begin(window);
        const real end = from[here + 1] < reach ? from[here + 1] : reach;
        const real middle = from[here] + (end - from[here]) / 2;
        wide mean[PARTS], sum[PARTS];
        if (!mean_batch(p, all, size, at, mean) || from[here] > end) {
            continue;
        }
        for (int side = 0; side < PARTS; ++side) {
            sum[side] = none;
        }
        for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
            const int s = strand_at[k];
            const int now = window % CYCLE * NAME_STRANDS + s;
            series_at_batch(all + (size_t)s * size, degree + 1,
                            ((middle - strand_start[now]) + strand_excess[now]) * strand_scale[s] - 1, sum);
        }
        for (int side = 0; side < PARTS; ++side) {
            enlarge_batch(&p[side].mean[output], &mean[side]);
            enlarge_batch(&p[side].largest[output], &sum[side]);
            const wide half_more = (real)1.5 * p[side].mean[output], much_more = 4 * p[side].largest[output];
            const mask less = half_more < much_more;
            p[side].worth[output] = CHOSEN(less, half_more, much_more);
        }
    }
}
