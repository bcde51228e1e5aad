/* sets_batch.c: many sets of parameters side by side: misfits.
 * Plain C that is put below all of NAME.c; what stands below the first empty line. */
#include "misfit.c"

void name_sets_sizes(size_t *sizes);
void name_sets_misfits(const name_parameters *parameters, size_t sets, name_batch *batch, const name_data *data,
                       int *status, name_real *estimate, name_real *out);

/* Of a batch and of data, in bytes. */
void name_sets_sizes(size_t *sizes)
{
    sizes[0] = sizeof(name_batch);
    sizes[1] = sizeof(name_data);
}

/* Of each set the status, the estimate, and the sum of the squares of its misfits. What is refused beside others is
 * built again by itself. */
void name_sets_misfits(const name_parameters *parameters, size_t sets, name_batch *batch, const name_data *data,
                       int *status, name_real *estimate, name_real *out)
{
    for (size_t set = 0; set < sets; set += NAME_WIDTH) {
        name_real misfit[NAME_WIDTH];
        (void)name_build_batch(batch, parameters + set, sets - set);
        name_batch_misfit(batch, data, misfit);
        for (size_t k = 0; k < NAME_WIDTH && set + k < sets; ++k) {
            status[set + k] = batch->status[k];
            estimate[set + k] = batch->estimate[k];
            out[set + k] = misfit[k];
        }
        for (size_t k = 0; k < NAME_WIDTH && set + k < sets; ++k) {
            if (status[set + k]) {
                status[set + k] = name_build_batch(batch, parameters + set + k, 1);
                name_batch_misfit(batch, data, misfit);
                estimate[set + k] = batch->estimate[0];
                out[set + k] = misfit[0];
            }
        }
    }
}
