/* tangent.c: a model with its derivatives. COUNT is how many samples are asked for. */

volatile name_real any_number;
volatile int any_lane;

int main(void)
{
    /*@ widen_hints global:"all", 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, NAME_DEGREE,
        NAME_DEGREE + 1, NAME_DEGREE + 2, NAME_DEGREE + 3; */
    static name_tangent tangent;
    static name_parameters parameters;
    static name_real rows[(NAME_LANES + 1) * NAME_OUTPUTS * COUNT + 1];
    for (size_t k = 0; k < sizeof parameters / sizeof(name_real); ++k) {
        ((name_real *)&parameters)[k] = any_number;
    }
    int status = name_build_tangent(&tangent, &parameters);
    /* through a pointer Eva sees the end of what it is given, not that of its series */
    for (int k = 0; k < NAME_WINDOWS; ++k) {
        const size_t end = tangent.value.place[k] + (size_t)NAME_STRANDS * (size_t)(tangent.value.degree[k] + 2);
        if (tangent.value.degree[k] > NAME_DEGREE || end > sizeof tangent.series[0] / sizeof *tangent.series[0]) {
            return rows[(NAME_LANES + 1) * NAME_OUTPUTS * COUNT + 1] > 0; /* an alarm */
        }
    }
    status |= name_tangent_estimate(&tangent, any_lane) > 0;
    return status | name_tangent_sample(&tangent, any_number, any_number, COUNT, rows);
}
