/* stream.c: a stream that goes on for ever, under any loads and steps. */

volatile name_real any_number;
volatile int any_choice;

int main(void)
{
    /*@ widen_hints global:"all", -2, -1, 0, 1, NAME_PANELS - 1, NAME_PANELS, NAME_BREAKPOINTS - 1, NAME_BREAKPOINTS; */
    static name_state state;
    name_real load[NAME_LOADS];
    name_real out[NAME_OUTPUTS];
    int status = 0;
    name_init(&state);
    while (any_choice) {
        for (int k = 0; k < NAME_LOADS; ++k) {
            load[k] = any_number;
        }
        status |= name_step(&state, any_number, load, out);
    }
    return status + (name_lost(&state) > 0);
}
