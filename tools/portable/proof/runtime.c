/* runtime.c: a model of any parameters, read anywhere. COUNT is how many samples are asked for. */

volatile name_real any_number;

int main(void)
{
    /*@ widen_hints global:"all", 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, NAME_DEGREE,
        NAME_DEGREE + 1, NAME_DEGREE + 2, NAME_DEGREE + 3; */
    static name_work work;
    static name_model model;
    static name_parameters parameters;
    static name_real rows[NAME_OUTPUTS * COUNT + 1];
    name_real out[NAME_OUTPUTS];
    for (size_t k = 0; k < sizeof parameters / sizeof(name_real); ++k) {
        ((name_real *)&parameters)[k] = any_number;
    }
    int status = name_build_with(&work, &model, &parameters);
    /* through a pointer Eva sees the end of a model, not that of its series */
    for (int k = 0; k < NAME_WINDOWS; ++k) {
        const size_t end = model.place[k] + (size_t)NAME_STRANDS * (size_t)(model.degree[k] + 2);
        if (model.degree[k] > NAME_DEGREE || end > sizeof model.series / sizeof *model.series) {
            return rows[NAME_OUTPUTS * COUNT + 1] > 0; /* an alarm */
        }
    }
    status |= name_model_eval(&model, any_number, out);
    status |= name_model_sample(&model, any_number, any_number, COUNT, rows);
    return status + (name_error_estimate(&model) > 0);
}
