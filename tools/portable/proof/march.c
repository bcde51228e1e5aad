/* march.c: a march that is driven for ever, under its own loads and under any that are given, and read anywhere. */

volatile name_real any_number;
volatile int any_choice;

int main(void)
{
    /*@ widen_hints global:"all", 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 32, 64; */
    static name_state state;
    static name_real loads[NAME_SOURCES * NAME_POINTS + 1];
    name_real out[NAME_OUTPUTS];
    name_real energy = 0;
    int status = 0;
    name_init(&state);
    while (any_choice) {
        for (int k = 0; k < NAME_SOURCES * NAME_POINTS; ++k) {
            loads[k] = any_number;
        }
        status |= name_advance(&state, any_choice ? loads : NULL);
        status |= name_read(&state, any_number, out);
        energy = name_energy(&state);
    }
    return status + (energy > 0);
}
