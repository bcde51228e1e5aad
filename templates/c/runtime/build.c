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

/* How an output weighs waves, added up. */
static real weight_of(const laws *law, int output)
{
    real weight = faint; /* gains may underflow */
    for (int k = 0; k < NAME_HEARD; ++k) {
        weight += heard_output[k] == output ? magnitude(law->gain[k]) : (real)0;
    }
    return weight;
}

/* An error relative to what is surely there of an output; of one that waves have reached that may be nothing. */
static real relative(const laws *law, const laws *slope, int lane, int output, real error, real largest)
{
    if (silent[output]) {
        return 0;
    }
    if (error < largest) {
        return error / (largest - error);
    }
    return !(error <= 0) && (largest > 0 || reached(law, slope, lane, output)) ? infinity() : (real)0;
}

/* How often a velocity of size 1 is rounded, about: the sums of a body, of so many coefficients, lose up to a sixteenth of
 * the degree squared. So does what is read, of its own size. */
static real read_by(int degree)
{
    return unit * (real)(degree * degree) / 16;
}

static real rounded_by(int degree)
{
    return unit * (real)(degree + NAME_WINDOWS) + (NAME_BODIES > 0 ? read_by(degree) : (real)0);
}

/* Of the largest value of an output, about what `missed`, as a velocity, and reading at a degree make of it, at worst. */
static real estimated(const work_of *m, const laws *law, real missed, int degree)
{
    real worst = 0;
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        const real largest = m->largest[output];
        const real error = weight_of(law, output) * missed + read_by(degree) * largest;
        worst = larger(worst, relative(law, law, OF_VALUES, output, error, largest));
    }
    return worst;
}

/* How far a build has come. */
typedef struct {
    int window, degree, event;
    size_t place;
    real missed, size, heard;
    real leak, seen; /* what the window of now misses, and `size` with it */
} progress;

/* A derivative may miss so much more of itself than a value. */
enum { LENIENT = 64 };

static int higher_than(int degree)
{
    const int higher = degree + degree / 4;
    return higher < NAME_DEGREE ? higher : NAME_DEGREE;
}

/* About what velocities are wrong by, at worst. Errors were up to five times what polynomials miss; docs/march.md of
 * wavesym has what was measured. */
static real wrong_by(real missed, real size, int degree)
{
    return 6 * missed + rounded_by(degree) * size;
}

static int ended(const work_of *m, model_of *made, const laws *law, const progress *now)
{
    const real missed = wrong_by(now->missed, now->size, now->degree);
    made->built = finite_number(now->size) && finite_number(missed) && finite_number(now->heard);
    made->estimate = made->built ? estimated(m, law, missed, now->degree) : not_a_number();
    return !made->built;
}

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
