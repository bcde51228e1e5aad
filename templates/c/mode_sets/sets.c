/* sets.c: many sets of parameters, one after the other, for those who load this into a process. */
#include "peaks.c"

void name_sets(const name_parameters *parameters, size_t sets, model *m, const real *tau, size_t count, int *status,
               real *estimate, real *rounded, real *peaks, real *values);
void name_missed(const name_parameters *parameters, const real *step, size_t sets, model *m, real *missed);

/* Histories at tau[count], ascending, values[output*count + k]. */
static void read_all(const model *m, const real *tau, size_t count, real *values)
{
    reader r;
    begin_reading(m, &r);
    for (size_t k = 0; k < count; ++k) {
        real found[FILLED];
        read_at(m, &r, tau[k], found);
        for (size_t output = 0; output < OUTPUTS; ++output) {
            values[output * count + k] = found[output];
        }
    }
}

/* Of each set extremes, peaks[(set*OUTPUTS + output)*4 ...], by which its error is estimated, what rounding may do to
 * outputs, rounded[set*OUTPUTS + output], and histories; nothing of one that is refused. */
void name_sets(const name_parameters *parameters, size_t sets, model *m, const real *tau, size_t count, int *status,
               real *estimate, real *rounded, real *peaks, real *values)
{
    for (size_t k = 0; k < sets; ++k) {
        real *const found = peaks + k * 4 * OUTPUTS;
        projection p;
        damping_rule rule;
        real largest[OUTPUTS];
        if (find_model(m, &parameters[k], &p, &rule)) {
            find_peaks(m, found);
            for (int output = 0; output < OUTPUTS; ++output) {
                largest[output] = most_of(-found[4 * output], found[4 * output + 2]);
            }
            judge(m, &p, &rule, largest, rounded + k * OUTPUTS);
            read_all(m, tau, count, values + k * OUTPUTS * count);
        }
        status[k] = m->status;
        estimate[k] = m->estimate;
    }
}

/* What differences over a `step`, relative to a parameter, miss of derivatives of all outputs, times the parameter, if it
 * changes all frequencies as much as one parameter can, by half of it: a mode that has turned by x more is missed to x^3/3
 * of how fast it changes, and altogether, and three times, where this is much. */
static void missed_turns(const model *m, const projection *p, real step, real *missed)
{
    for (int output = 0; output < OUTPUTS; ++output) {
        missed[output] = 0;
    }
    for (int load = 0; load < LOADS; ++load) {
        const history f = history_of(m, load, 0);
        for (int n = 0; n < FOUND; ++n) {
            const real w = p->w[n];
            const real decay = m->damping[n] * w;
            const real memory = decay * tau_max > 1 ? 1 / decay : tau_max;
            const real turned = w * memory / 2;
            const real x = turned * step;
            const real lost = turned * least_of(x * x * x / 3, 3);
            const real size = swing_of(&f, w, m->damping[n], p->wrong[n]).free * fabs(p->share[load][n].value);
            for (int output = 0; output < OUTPUTS; ++output) {
                const int order = output_order[output];
                const real fast = order == 2 ? w * w : order == 1 ? w : 1;
                missed[output] += is_zero[output] ? 0 : fabs(p->output[output][n].value) * size * fast * lost;
            }
        }
    }
}

/* What differences over a relative step[set] miss of derivatives of outputs, missed[set*OUTPUTS + output]. */
void name_missed(const name_parameters *parameters, const real *step, size_t sets, model *m, real *missed)
{
    for (size_t k = 0; k < sets; ++k) {
        projection p;
        damping_rule rule;
        if (find_model(m, &parameters[k], &p, &rule)) {
            missed_turns(m, &p, step[k], missed + k * OUTPUTS);
        }
    }
}
