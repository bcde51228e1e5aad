/* batch.c: a batch of none or one, and any of its models. */

volatile name_real any_number;
volatile int any_choice;

int main(void)
{
    /*@ widen_hints global:"all", 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, NAME_DEGREE,
        NAME_DEGREE + 1, NAME_DEGREE + 2, NAME_DEGREE + 3; */
    static name_batch batch;
    static name_model model;
    static name_parameters parameters;
    name_real out[NAME_OUTPUTS];
    for (size_t k = 0; k < sizeof parameters / sizeof(name_real); ++k) {
        ((name_real *)&parameters)[k] = any_number;
    }
    int status = name_build_batch(&batch, &parameters, any_choice ? 1 : 0);
    /* through a pointer Eva sees the end of a batch, not that of its series */
    for (int k = 0; k < NAME_WINDOWS; ++k) {
        const size_t end = batch.place[k] + (size_t)NAME_STRANDS * (size_t)(batch.degree[k] + 2);
        if (batch.degree[k] > NAME_DEGREE || end > sizeof batch.series / sizeof *batch.series) {
            return out[NAME_OUTPUTS] > 0; /* an alarm */
        }
    }
    status |= name_batch_model(&batch, any_choice, &model);
    return status | name_model_eval(&model, any_number, out);
}
