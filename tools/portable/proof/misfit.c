/* misfit.c: what a model misses of any values at COUNT instants, which are given. */

volatile name_real any_number;

int main(void)
{
    /*@ widen_hints global:"all", 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, NAME_DEGREE,
        NAME_DEGREE + 1, NAME_DEGREE + 2, NAME_DEGREE + 3; */
    static name_batch batch;
    static name_data data;
    static name_parameters parameters;
    static name_real numbers[1 << 14];
    name_real tau[COUNT], values[NAME_OUTPUTS * COUNT], misfit[NAME_WIDTH];
    for (int k = 0; k < COUNT; ++k) {
        tau[k] = (name_real)k + (name_real)0.25;
    }
    for (int k = 0; k < NAME_OUTPUTS * COUNT; ++k) {
        values[k] = any_number;
    }
    for (size_t k = 0; k < sizeof parameters / sizeof(name_real); ++k) {
        ((name_real *)&parameters)[k] = any_number;
    }
    if (name_data_size(tau, COUNT) > sizeof numbers / sizeof *numbers) {
        return numbers[1 << 14] > 0; /* an alarm: there is room for these */
    }
    int status = name_data_init(&data, numbers, tau, values, COUNT);
    status |= name_build_batch(&batch, &parameters, 1);
    name_batch_misfit(&batch, &data, misfit);
    return status + (misfit[0] > 0);
}
