/* values.c: programs that give values at any tau. COUNT is how many samples are asked for. */

volatile name_real any_number;

int main(void)
{
    /*@ widen_hints global:"all", 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 32, 64; */
    static name_real rows[NAME_OUTPUTS * COUNT + 1];
    name_real out[NAME_OUTPUTS];
    return name_eval(any_number, out) | name_sample(any_number, any_number, COUNT, rows);
}
