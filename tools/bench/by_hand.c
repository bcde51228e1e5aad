/* Characteristics with exponential integration of order 4, by hand for one scene: sizes are constants of the compiler,
 * loads begin at whole tau, samples and outputs lie on the grid. From new parameters to samples in one call, or to peaks.
 *
 * q' + rate q = r at a body, r = alpha a + beta b + load, with r a cubic through four neighbouring points of a window.
 * Defined from outside: NODES, STEPS (of a window), WINDOWS, TERMS, OUTPUTS, EVENTS, STRIDE (steps from sample to sample), KINK
 * (fronts pass outputs at multiples of so many steps).
 */
#include <math.h>
#include <stddef.h>

/* what does not change with parameters: of each term the output, sender, direction (1 is right), sign and lag in steps */
extern const int of_output[], of_node[], of_way[], of_lag[], event_window[], event_node[];
extern const double of_sign[];

static double wave[WINDOWS + 1][2][NODES][STEPS + 1];

/* integral over s in [0, 1] of exp(-z (1 - s)) s^j, j = 0 ... 3 */
static void moments(double z, double *m)
{
    if (z > 1) {
        m[0] = (1 - exp(-z)) / z;
        for (int j = 1; j < 4; ++j) {
            m[j] = (1 - j * m[j - 1]) / z;
        }
        return;
    }
    for (int j = 0; j < 4; ++j) {
        double term = 1.0 / (j + 1);
        m[j] = 0;
        for (int i = 0; i < 22; ++i) {
            m[j] += term;
            term *= -z / (i + j + 2);
        }
    }
}

/* weights of r at first ... first + 3, in steps from the beginning of one */
static void weights(const double *m, double scale, int first, double *w)
{
    for (int j = 0; j < 4; ++j) {
        double c[4] = {1, 0, 0, 0};
        int degree = 0;
        for (int k = 0; k < 4; ++k) {
            if (k != j) {
                const double place = first + k, apart = j - k;
                ++degree;
                for (int n = degree; n > 0; --n) {
                    c[n] = (c[n - 1] - place * c[n]) / apart;
                }
                c[0] *= -place / apart;
            }
        }
        w[j] = scale * (c[0] * m[0] + c[1] * m[1] + c[2] * m[2] + c[3] * m[3]);
    }
}

/* inertia, alpha, beta, gamma, velocity [NODES]; before [2][NODES]: waves until tau = 0; loads [EVENTS][3] */
void parameters_to_samples(const double *inertia, const double *alpha, const double *beta, const double *gain,
                           const double *velocity, const double *before, const double *loads, size_t count, double *out)
{
    const double h = 1.0 / STEPS;
    double first[NODES][4], inner[NODES][4], last[NODES][4], decay[NODES], q[NODES];
    double load[NODES][3] = {{0}};
    int event = 0;
    for (int n = 0; n < NODES; ++n) {
        q[n] = velocity[n];
        decay[n] = 0;
        if (inertia[n] > 0) {
            const double z = gain[n] / inertia[n] * h;
            double m[4];
            moments(z, m);
            decay[n] = exp(-z);
            weights(m, h / inertia[n], 0, first[n]);
            weights(m, h / inertia[n], -1, inner[n]);
            weights(m, h / inertia[n], -2, last[n]);
        }
        for (int way = 0; way < 2; ++way) {
            for (int k = 0; k <= STEPS; ++k) {
                wave[0][way][n][k] = before[way * NODES + n];
            }
        }
    }
    for (int window = 0; window < WINDOWS; ++window) {
        for (int n = 0; n < NODES; ++n) {
            load[n][0] += load[n][1] + load[n][2];
            load[n][1] += 2 * load[n][2];
        }
        for (; event < EVENTS && event_window[event] == window; ++event) {
            for (int j = 0; j < 3; ++j) {
                load[event_node[event]][j] += loads[3 * event + j];
            }
        }
        for (int n = 0; n < NODES; ++n) {
            static const double none[STEPS + 1];
            const double *a = n > 0 ? wave[window][1][n - 1] : none;
            const double *b = n + 1 < NODES ? wave[window][0][n + 1] : none;
            double *left = wave[window + 1][0][n], *right = wave[window + 1][1][n];
            const double *w = inner[n];
            double r[STEPS + 1], v[STEPS + 1];
            const double al = alpha[n], be = beta[n], c0 = load[n][0], c1 = load[n][1], c2 = load[n][2], e = decay[n];
            for (int k = 0; k <= STEPS; ++k) {
                const double s = k * h;
                r[k] = al * a[k] + be * b[k] + (c0 + s * (c1 + s * c2));
            }
            if (inertia[n] > 0) {
                double now = q[n];
                v[0] = now;
                for (int k = 1; k + 1 < STEPS; ++k) {
                    v[k + 1] = w[0] * r[k - 1] + w[1] * r[k] + w[2] * r[k + 1] + w[3] * r[k + 2];
                }
                v[1] = first[n][0] * r[0] + first[n][1] * r[1] + first[n][2] * r[2] + first[n][3] * r[3];
                v[STEPS] = last[n][0] * r[STEPS - 3] + last[n][1] * r[STEPS - 2] + last[n][2] * r[STEPS - 1] +
                           last[n][3] * r[STEPS];
                for (int k = 1; k <= STEPS; ++k) {
                    now = e * now + v[k];
                    v[k] = now;
                }
                q[n] = now;
            } else {
                const double g = 1 / gain[n];
                for (int k = 0; k <= STEPS; ++k) {
                    v[k] = g * r[k];
                }
            }
            for (int k = 0; k <= STEPS; ++k) {
                left[k] = v[k] - a[k];
                right[k] = v[k] - b[k];
            }
        }
    }
    for (size_t k = 0; k < OUTPUTS * count; ++k) {
        out[k] = 0;
    }
    for (int term = 0; term < TERMS; ++term) {
        double *row = out + (size_t)of_output[term] * count;
        const double sign = of_sign[term];
        for (size_t k = 0; k < count;) {
            const long at = (long)k * STRIDE - of_lag[term] + STEPS; /* from window -1 on */
            const long window = at / STEPS, place = at % STEPS;
            const double *from = wave[window][of_way[term]][of_node[term]] + place;
            const size_t here = (size_t)((STEPS - place + STRIDE - 1) / STRIDE), left = count - k;
            const size_t end = here < left ? here : left;
            for (size_t j = 0; j < end; ++j) {
                row[k + j] += sign * from[j * STRIDE];
            }
            k += end;
        }
    }
}

/* How much higher than its beginning a parabola through 0, one and two is between 0 and 2. */
static double higher(double one, double two)
{
    const double bend = 2 * one - two, rise = (4 * one - two) / 2;
    return bend > 0 && rise > 0 && rise < 2 * bend ? rise * rise / (2 * bend) : 0;
}

/* The top of a row times the sign: of a parabola through the highest sample and its neighbours, or, where a front may pass
 * there, through it and the two before or after it. */
static double top(const double *row, size_t count, double sign)
{
    size_t at = 0;
    double rises = 0;
    for (size_t k = 1; k < count; ++k) {
        at = sign * row[k] > sign * row[at] ? k : at;
    }
    const double here = row[at];
    if (at * STRIDE % KINK != 0 && at + 1 < count) {
        rises = higher(sign * (here - row[at - 1]), sign * (row[at + 1] - row[at - 1])) - sign * (here - row[at - 1]);
    } else {
        const double before = at > 1 ? higher(sign * (row[at - 1] - here), sign * (row[at - 2] - here)) : 0;
        const double after = at + 2 < count ? higher(sign * (row[at + 1] - here), sign * (row[at + 2] - here)) : 0;
        rises = before > after ? before : after;
    }
    return here + sign * (rises > 0 ? rises : 0);
}

/* Of many sets, each as above, the least and the greatest value of each output: peaks [sets][OUTPUTS][2]. */
void sets_to_peaks(size_t sets, const double *inertia, const double *alpha, const double *beta, const double *gain,
                   const double *velocity, const double *before, const double *loads, size_t count, double *rows,
                   double *peaks)
{
    for (size_t set = 0; set < sets; ++set) {
        const size_t at = set * NODES;
        parameters_to_samples(inertia + at, alpha + at, beta + at, gain + at, velocity + at, before + 2 * at,
                              loads + set * EVENTS * 3, count, rows);
        for (size_t output = 0; output < OUTPUTS; ++output) {
            peaks[(set * OUTPUTS + output) * 2] = top(rows + output * count, count, -1);
            peaks[(set * OUTPUTS + output) * 2 + 1] = top(rows + output * count, count, 1);
        }
    }
}
