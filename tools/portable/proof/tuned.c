/* tuned.c: a stream of any parameters, that goes on for ever under any loads and steps, and begins anew. */

volatile name_real any_number;
volatile int any_choice;

int main(void)
{
    /*@ widen_hints global:"all", -2, -1, 0, 1, NAME_PANELS - 1, NAME_PANELS, NAME_BREAKPOINTS - 1, NAME_BREAKPOINTS; */
    static name_state state;
    static name_parameters parameters;
    name_real load[NAME_LOADS];
    name_real out[NAME_OUTPUTS];
    for (size_t k = 0; k < sizeof parameters / sizeof(name_real); ++k) {
        ((name_real *)&parameters)[k] = any_number;
    }
    int status = name_build(&state, &parameters);
    while (any_choice) {
        for (int k = 0; k < NAME_LOADS; ++k) {
            load[k] = any_number;
        }
        status |= name_step(&state, any_number, load, out);
        if (any_choice) {
            name_init(&state);
        }
    }
    return status + (name_lost(&state) > 0);
}
