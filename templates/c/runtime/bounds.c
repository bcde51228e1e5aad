/* bounds.c: a proved bound of the errors of a model.
 * Plain C that stands below what says how wrong its waves may be in generated files, which have what stands below the
 * first empty line. */
#include "bound.c"

/* What integrals may be wrong by after a window. */
static void add_up(const work_of *m, wrong *w, const int *summed, int window, int degree)
{
    const real spare = (real)(64 * (degree + 4) * (NAME_PANELS + 1)) * least_number;
    for (int k = 0; k < NAME_HEARD; ++k) {
        if (summed[k]) {
            real error, read;
            wrong_heard(w, k, window, &error, &read);
            const real size = window_length * (read / w->beside.least);
            const real total = magnitude(m->total[k]) + size;
            w->beside.most[k] = larger(w->beside.most[k], total);
            w->beside.total[k] += window_length * error + spare +
                                  unit * (2 * (real)(degree + 16) * size + (real)(2 * NAME_PANELS + 2) * total);
        }
    }
}

/* What an output may be wrong by. Nothing that is added up has been larger before the last window than on it. */
static real output_wrong(const laws *law, const wrong *w, const int *summed, int output, int degree)
{
    const real spare = (real)(64 * (degree + 4) * (NAME_PANELS + 1)) * least_number;
    real sum = 0;
    for (int k = 0; k < NAME_HEARD; ++k) {
        if (heard_output[k] == output) {
            real error, read;
            wrong_heard(w, k, NAME_WINDOWS - 1, &error, &read);
            if (summed[k]) {
                error = w->beside.total[k] + w->beside.reading[0] * w->beside.most[k];
                read = 2 * window_length * read;
            }
            sum += (magnitude(law->gain[k]) + faint) * (error + read) + spare;
        }
    }
    return sum;
}

/* Where an output is larger than before, on a window that ends before TAU_MAX. */
static void remember(const work_of *m, wrong_beside *w, int window)
{
    const int last = in_cycle(window, 0) + SECTIONS;
    for (int output = 0; output < NAME_OUTPUTS && cycle_begin(window) + from[last] <= NAME_TAU_MAX; ++output) {
        if (m->largest[output] > w->largest[output]) {
            w->largest[output] = m->largest[output];
            w->window[output] = window;
        }
    }
}

/* What is seen of an output on the section with its largest mean. */
static real size_seen(const work_of *m, const model_of *made, const wrong_beside *w, int output)
{
    const int window = w->window[output];
    const real *const all = made->series + made->place[window];
    const real begin = cycle_begin(window);
    int section = 0;
    real largest = 0, most = m->largest[output];
    real t[BLOCK], values[BLOCK];
    for (int of = 0; of < SECTIONS && begin + from[in_cycle(window, of) + 1] <= NAME_TAU_MAX; ++of) {
        const int at = of * NAME_OUTPUTS + output;
        real mean = 0;
        for (int k = first_strand[at]; k < first_strand[at + 1]; ++k) {
            mean += all[(size_t)strand_at[k] * (size_t)(made->degree[window] + 2)];
        }
        if (magnitude(mean) > largest) {
            largest = magnitude(mean);
            section = of;
        }
    }
    const int here = in_cycle(window, section);
    for (int j = 0; j < BLOCK; ++j) {
        t[j] = from[here] + (from[here + 1] - from[here]) * (offset[j] / (real)BLOCK);
    }
    output_block(made, made->series, window, section * NAME_OUTPUTS + output, t, values);
    for (int j = 0; j < BLOCK && begin + t[j] <= NAME_TAU_MAX; ++j) {
        most = larger(most, values[j]);
    }
    return most;
}

int name_error_bound_with(
    name_work *work, name_model *model, const name_parameters *parameters, name_real *bound)
{
    laws law;
    wrong w;
    int summed[NAME_HEARD + 1] = {0};
    progress now = {0, LEAST, 0, 0, 0, 0, 0, 0, 0};
    int status = begun(work, model, parameters, &law);
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        bound[output] = not_a_number();
    }
    if (status) {
        return status;
    }
    begun_wrong(work, &law, &w);
    for (int t = 0; t < first_term[NAME_STRANDS]; ++t) {
        summed[term_heard[t]] = term_summed[t];
    }
    while (status == 0 && now.window < NAME_WINDOWS) {
        const int window = now.window;
        const int event = now.event;
        status = next_window(work, &law, &now);
        if (status == 0) {
            kept(work, model, &law, &now);
            pressed(&w.beside, work->change, window, event);
            begun_reading(&w.beside, now.degree);
            worsen(work, &law, &w, window, now.degree);
            add_up(work, &w, summed, window, now.degree);
            remember(work, &w.beside, window);
        }
    }
    status = status ? status : ended(work, model, &law, &now);
    for (int output = 0; output < NAME_OUTPUTS && status == 0; ++output) {
        /* a hundredth for what is of second order in a rounding, and for the roundings of this here */
        const real error = output_wrong(&law, &w, summed, output, now.degree) * (real)1.01;
        const real size = size_seen(work, model, &w.beside, output);
        const real known = error < size && finite_number(w.energy) ? error / (size - error) * (1 + 4 * unit) : infinity();
        bound[output] = silent[output] ? 0 : known;
    }
    return status;
}
