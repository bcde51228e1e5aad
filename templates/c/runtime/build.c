/* build.c: models of a chain, and their derivatives.
 * Plain C that stands below the text of march.c in generated files, which have what stands below the first
 * empty line. */
#include "march.c"

#undef num
#undef OF
#undef PICK
#undef SIZE
#undef ZERO
#undef FUSED

/* Add to all strands of a window what is heard of waves: each times its gain, or their integrals from tau = 0 on, of
 * which `total` is what windows before have brought. */
static void listen(const work_of *m, track_of *waves, const real *gains, real *total, int window, int degree, real *all)
{
    real sum[NAME_DEGREE + 2];
    for (int s = 0; s < NAME_STRANDS; ++s) {
        real *const c = all + (size_t)s * (size_t)(degree + 2);
        for (int t = first_term[s]; t < first_term[s + 1]; ++t) {
            const real *const w = waves[slot(term_track[t], window, term_back[t])][term_panel[t]];
            const int heard = term_heard[t];
            const real gain = gains[heard];
            if (term_summed[t]) {
                const real length = half_length[term_panel[t]];
                integrate(m, w, degree, sum);
                const real low = length * end_value(sum, degree + 1, term_low[t]);
                c[0] += gain * (total[heard] - low);
                for (int k = 1; k <= degree + 1; ++k) {
                    c[k] += gain * length * sum[k];
                }
                total[heard] += length * end_value(sum, degree + 1, term_high[t]) - low;
            } else {
                for (int k = 0; k <= degree; ++k) {
                    c[k] += gain * w[k];
                }
            }
        }
    }
}

/* 0, 1 for a bad number, or 2 for bodies so light, or springs so stiff, that a rounding of how they move on a panel is as
 * much as they move: no degree is enough then, but by chance. */
static int refused(const laws *law)
{
    real fastest = 0;
    if (!laws_within_reach(law)) {
        return 1;
    }
    for (int joint = 0; joint < NAME_JOINTS; ++joint) {
        const real *const rates = law->rates + at_rates[joint];
        const int n = states_of(joint);
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j <= i; ++j) {
                fastest = larger(fastest, (unit * rates[i * n + j]) * (unit * rates[j * n + i]));
            }
        }
    }
    return window_length * window_length * fastest < 1 ? 0 : 2;
}

/* What begins a march. */
static void started(work_of *m, const laws *law)
{
    start_waves(m->waves, law, LEAST + SPARE);
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = law->begun[k];
    }
    tell_inverses(m->inverse, LEAST + SPARE);
    tabulate(m, law, 1, LEAST);
}

/* The next window begins as this one ends. */
static void settle(work_of *m)
{
    for (int k = 0; k < NAME_STATES; ++k) {
        m->state[0][k] = m->state[1][k];
    }
}

/* The window of now at the degree of now. */
static void march_window(work_of *m, const laws *law, progress *now)
{
    now->seen = now->size;
    now->leak = 0;
    march(m, law, 1, now->window, now->degree, &now->seen, &now->leak);
}

/* The same at a higher degree. */
static void heighten(work_of *m, const laws *law, progress *now)
{
    const int before = now->degree;
    now->degree = higher_than(before);
    for (int place = 0; place < NAME_SLOTS; ++place) {
        for (int panel = 0; panel < NAME_PANELS; ++panel) {
            for (int k = before + 1; k < now->degree + SPARE; ++k) {
                m->waves[place][panel][k] = 0; /* what series had not */
            }
        }
    }
    tell_inverses(m->inverse, now->degree + SPARE);
    tabulate(m, law, 1, now->degree);
    march_window(m, law, now);
}
