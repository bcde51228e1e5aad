/* steps.c: a program of steps that goes on for ever, under any loads and steps. */

volatile name_real any_number;
volatile int any_choice;

int main(void)
{
    /*@ widen_hints global:"all", 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 32, 64; */
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
    return status;
}
