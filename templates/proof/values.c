/* values.c: programs that give values at any tau. COUNT is how many samples are asked for. */

volatile name_real any_number;

int main(void)
{
    static name_real rows[NAME_OUTPUTS * COUNT + 1];
    name_real out[NAME_OUTPUTS];
    return name_eval(any_number, out) | name_sample(any_number, any_number, COUNT, rows);
}
