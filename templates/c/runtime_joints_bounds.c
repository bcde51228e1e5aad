/* runtime_joints_bounds.c: a proved bound of the errors of a model.
 * Plain C that stands below what says how wrong its waves may be in generated files, which have what stands below the
 * first empty line. */
#include "runtime_joints_bound.c"

/* What the outputs of a window may be wrong by. */
static void outputs_wrong(const model_of *m, const laws *law, wrong *w, int window, int degree)
{
    real strand[NAME_STRANDS];
    const real spare = (real)(64 * (degree + 4)) * least_number;
    for (int s = 0; s < NAME_STRANDS; ++s) {
        const real *const c = m->series + m->place[window] + (size_t)s * (size_t)(degree + 2);
        const real terms = (real)(first_term[s + 1] - first_term[s]);
        strand[s] = spare;
        real weight = (real)(degree + 2), more = 4, reading = 0; /* (k + 1)(k + 2) + degree */
        for (int k = 0; k <= degree + 1; ++k) {
            reading += weight * magnitude(c[k]);
            weight += more;
            more += 2;
        }
        strand[s] += 12 * unit * reading;
        for (int t = first_term[s]; t < first_term[s + 1]; ++t) {
            const int heard = term_heard[t];
            const real length = 2 * half_length[term_panel[t]];
            const real gain = magnitude(law->gain[heard]);
            real sender, size;
            wrong_heard(m, w, t, window, &sender, &size);
            if (term_summed[t]) {
                const real total = magnitude(m->total[heard]) + length * size;
                w->beside.total[heard] += length * sender + unit * ((real)(degree + 16) * length * size + 2 * total) + spare;
                strand[s] += gain * (w->beside.total[heard] + unit * (roundings + terms + 4) * (total + length * size));
            } else {
                strand[s] += gain * (sender + unit * (roundings + terms + 4) * size);
            }
        }
    }
    for (int section = 0; section < SECTIONS && cycle_begin(window) + from[in_cycle(window, section)] <= NAME_TAU_MAX; ++section) {
        for (int output = 0; output < NAME_OUTPUTS; ++output) {
            const int at = section * NAME_OUTPUTS + output;
            real sum = 0;
            for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
                sum += strand[strand_at[k]];
            }
            w->beside.output[output] = larger(w->beside.output[output], known(sum));
        }
    }
}

int name_error_bound(name_model *model, const name_parameters *parameters, name_real *bound)
{
    laws law;
    wrong w;
    progress now = {0, LEAST, 0, 0, 0, 0, 0, 0, 0};
    int status = begun(model, parameters, &law);
    if (status == 0) {
        begun_wrong(&w, &law);
    }
    while (status == 0 && now.window < NAME_WINDOWS) {
        const int window = now.window;
        const int event = now.event;
        status = next_window(model, &law, &now);
        if (status == 0) {
            (void)pressed(&w.beside, model->change, window, event);
            worsen(model, &law, &w, window, now.degree);
            kept(model, &law, &now);
            outputs_wrong(model, &law, &w, window, now.degree);
        }
    }
    status = status ? status : ended(model, &law, &now);
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        bound[output] = not_a_number();
        if (status == 0) {
            /* a hundredth for what is of second order in a rounding, and for the roundings of this here */
            const real error = w.beside.output[output] * (real)1.01;
            const real most = model->largest[output];
            bound[output] = error < most ? error / (most - error) * (1 + 4 * unit) : is_silent(&law, output) ? 0 : infinity();
        }
    }
    return status;
}
