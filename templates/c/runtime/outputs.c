/* outputs.c: outputs as sums of waves, for one set of parameters and for many in lanes, and how large they are. */
#include "march.c"

/* The antiderivative of a series on a panel: all c_k but the first, which is 0. */
static void OF(integrate)(const real *inverse, const num *w, int degree, real half, num *c)
{
    c[0] = ZERO;
    c[1] = half * (degree > 1 ? (num)(w[0] - w[2] / 2) : w[0]);
    for (int k = 2; k < degree; ++k) {
        c[k] = (w[k - 1] - w[k + 1]) * (half * inverse[k]);
    }
    c[degree] = w[degree - 1] * (half * inverse[degree]);
    c[degree + 1] = w[degree] * (half * inverse[degree + 1]);
}

/* sum of c_k T_k(u), sooner at both ends of a panel and in its middle. */
static void OF(end_value)(const num *c, int degree, real u, num *sum)
{
    const int by = u < 0 || u > 0 ? 1 : 2;
    num some = ZERO, others = ZERO;
    if (u > -1 && u < 1 && by == 1) {
        OF(series_at)(c, 1, degree, u, sum);
        return;
    }
    for (int k = 0; k <= degree; k += 2 * by) {
        some += c[k];
        others += k + by <= degree ? c[k + by] : ZERO;
    }
    *sum = u > 0 ? some + others : some - others;
}

/* Add to a strand of a window a wave of each set, times a gain, or its integral from tau = 0 on, of which `total` is what
 * windows before have brought. */
static void OF(accumulate_term)(OF(march_state) *all, const real *inverse, const OF(laws) *law, int t, int window, int degree,
                                num *c)
{
    const int gain = term_gain[t], at = slot(term_track[t], window, term_back[t]);
    for (int side = 0; side < OF(parts); ++side) {
        const num *const w = all[side].waves[at][term_panel[t]];
        const num factor = law[side].gain[gain];
        num sum[NAME_DEGREE + 2];
        if (term_summed[t]) {
            OF(integrate)(inverse, w, degree, half_length[term_panel[t]], sum);
            num low, high;
            OF(end_value)(sum, degree + 1, term_low[t], &low);
            OF(end_value)(sum, degree + 1, term_high[t], &high);
            c[side] += factor * (all[side].total[gain] - low);
            all[side].total[gain] += high - low;
        }
        const num *const series = term_summed[t] ? sum : w;
        for (int k = term_summed[t]; k <= degree + term_summed[t]; ++k) {
            c[k * OF(parts) + side] += factor * series[k];
        }
    }
}

/* The same of both waves of a strand at once, which are all of it, and are not integrated; `sum` grows by magnitudes. What
 * lies behind a series is written, too. */
WITHIN void OF(accumulate_two)(OF(march_state) *all, const OF(laws) *law, int t, int window, int degree, num *c,
                               OF(pack) *sum)
{
    const num *w[OF(parts)], *v[OF(parts)];
    num one[OF(parts)], other[OF(parts)];
    UNROLLED
    for (int side = 0; side < OF(parts); ++side) {
        w[side] = all[side].waves[slot(term_track[t], window, term_back[t])][term_panel[t]];
        v[side] = all[side].waves[slot(term_track[t + 1], window, term_back[t + 1])][term_panel[t + 1]];
        one[side] = law[side].gain[term_gain[t]];
        other[side] = law[side].gain[term_gain[t + 1]];
    }
    for (int k = 0; k <= degree; k += OF(packed)) {
        UNROLLED
        for (int side = 0; side < OF(parts); ++side) {
            const OF(pack) first = *(const OF(pack) *)(w[side] + k), second = *(const OF(pack) *)(v[side] + k);
            const OF(pack) now = one[side] * first + other[side] * second;
            *(OF(pack) *)(c + k * OF(parts) + side) = now;
            sum[side] += SIZES_OF(now);
        }
    }
    for (int side = 0; side < OF(parts); ++side) {
        c[(degree + 1) * OF(parts) + side] = ZERO;
    }
}

/* Any strand of a window, or `more` in it; `weight` grows by what it stays below while it is read. */
static BY_ITSELF void OF(accumulate_strand)(OF(march_state) *all, const real *inverse, const OF(laws) *law, int s,
                                            int window, int degree, int more, num *c, num *weight)
{
    num rest[OF(parts)];
    for (int i = 0; i < (degree + 2) * OF(parts) && !more; ++i) {
        c[i] = ZERO;
    }
    for (int t = first_term[s]; t < first_term[s + 1]; ++t) {
        OF(accumulate_term)(all, inverse, law, t, window, degree, c);
    }
    for (int side = 0; side < OF(parts); ++side) {
        rest[side] = ZERO;
    }
    for (int i = 0; i <= degree + 1; ++i) {
        for (int side = 0; side < OF(parts); ++side) {
            rest[side] += SIZE_OF(c[i * OF(parts) + side]);
        }
    }
    for (int side = 0; side < OF(parts); ++side) {
        weight[side] += (real)(4 * (degree + 2)) * rest[side];
    }
}

/* The outputs on a window, or `more` in them, as series strand by strand. `weight` grows by what their values stay below
 * while they are read; what is no finite number stays there. */
static BY_ITSELF void OF(accumulate)(OF(march_state) *all, const real *inverse, const OF(laws) *law, int window, int degree,
                                     int more, num *c, num *weight)
{
    const int size = (degree + 2) * OF(parts);
    int others[NAME_STRANDS + 1], count = 0;
    OF(pack) sum[OF(parts)];
    for (int side = 0; side < OF(parts); ++side) {
        sum[side] = NOTHING;
    }
    for (int s = 0; s < NAME_STRANDS; ++s) { /* these first: no sum waits while other strands are computed */
        if (!more && has_two(s)) {
            OF(accumulate_two)(all, law, first_term[s], window, degree, c + s * size, sum);
        } else {
            others[count++] = s;
        }
    }
    for (int side = 0; side < OF(parts); ++side) {
        weight[side] += (real)(4 * (degree + 2)) * TOTAL_OF(sum[side]);
    }
    for (int k = 0; k < count; ++k) {
        OF(accumulate_strand)(all, inverse, law, others[k], window, degree, more, c + others[k] * size, weight);
    }
}

/* An output, or its derivative, on a section of a window (`at` counts sections and outputs), t after the start of its cycle. */
static void OF(value)(const num *all, int window, int degree, int at, real t, num *found)
{
    *found = ZERO;
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        const int s = strand_at[k];
        const num *const c = all + (size_t)s * (size_t)(degree + 2) * OF(parts);
        num sum;
        OF(series_at)(c, OF(parts), degree + 1, place_on(s, window, t), &sum);
        *found += sum;
    }
}

static void OF(mean_of)(const num *all, int degree, int at, num *mean)
{
    *mean = ZERO;
    for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
        *mean += all[(size_t)strand_at[k] * (size_t)(degree + 2) * OF(parts)];
    }
}

/* Look for the largest value of each output, or nearly: in the middle of sections whose mean, in some set, is half as much
 * again as that of those evaluated, or much more than what was found. */
static BY_ITSELF void OF(find_largest)(OF(extremes) *e, const num *all, int window, int degree)
{
    for (int at = 0; at < SECTIONS * NAME_OUTPUTS; ++at) {
        const int output = at % NAME_OUTPUTS, section = at / NAME_OUTPUTS;
        const real begin = from[in_cycle(window, section)], end = section_end(window, section);
        num mean, found;
        OF(mean_of)(all, degree, at, &mean);
        const TEST larger_mean = SIZE_OF(mean) > e->threshold[output];
        if (begin <= end && SOME(larger_mean)) {
            OF(value)(all, window, degree, at, begin + (end - begin) / 2, &found);
            OF(enlarge)(&e->mean[output], &mean);
            OF(enlarge)(&e->largest[output], &found);
            const num half_more = (real)1.5 * e->mean[output], much_more = 4 * e->largest[output];
            e->threshold[output] = PICK(half_more < much_more, half_more, much_more);
        }
    }
}
