/* misfits.h: what programs that compare models with data declare. */

typedef struct name_data name_data;

/* How many numbers the data at tau[count] need. */
size_t name_data_size(const name_real *tau, size_t count);

/* Data values[output*count + k] at tau[k], in any order; NaN where there is no value. `numbers` is the caller's, of
 * data_size, and stays in use. Returns 0, or 1 where a tau was out of range: its values do not count. */
int name_data_init(name_data *data, name_real *numbers, const name_real *tau, const name_real *values, size_t count);

/* Of every set the sum of the squares of (output - value) over all data: misfit[WIDTH], NaN for one that was refused. */
void name_batch_misfit(const name_batch *batch, const name_data *data, name_real *misfit);
