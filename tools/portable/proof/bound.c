/* bound.c: the proved bound of a model. */

volatile name_real any_number;

int main(void)
{
    /*@ widen_hints global:"all", 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, NAME_DEGREE,
        NAME_DEGREE + 1, NAME_DEGREE + 2, NAME_DEGREE + 3; */
    static name_work work;
    static name_model model;
    static name_parameters parameters;
    name_real bound[NAME_OUTPUTS];
    for (size_t k = 0; k < sizeof parameters / sizeof(name_real); ++k) {
        ((name_real *)&parameters)[k] = any_number;
    }
    return name_error_bound_with(&work, &model, &parameters, bound);
}
