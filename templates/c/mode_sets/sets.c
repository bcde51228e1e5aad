/* sets.c: many sets of parameters, one after the other, for those who load this into a process.
 * Plain C that stands below the text of peaks.c in generated files, which have what stands below the first empty line. */
#include "peaks.c"

void name_sets(const name_parameters *parameters, size_t sets, model *m, const real *tau, size_t count, int *status,
               real *estimate, real *peaks, real *values);

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

/* Of each set extremes, peaks[(set*OUTPUTS + output)*4 ...], by which its error is estimated, and histories; nothing of
 * one that is refused. */
void name_sets(const name_parameters *parameters, size_t sets, model *m, const real *tau, size_t count, int *status,
               real *estimate, real *peaks, real *values)
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
            judge(m, &p, &rule, largest);
            read_all(m, tau, count, values + k * OUTPUTS * count);
        }
        status[k] = m->status;
        estimate[k] = m->estimate;
    }
}
