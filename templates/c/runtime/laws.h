/* laws.h: stands for what runtime.c.j2 writes of laws, of numbers `num`, where that is read by itself. */
typedef struct {
    num rates[5 + 1];
    num pushed[5 + 1];
    num shown[5 + 1];
    num passed[5 + 1];
    num push[4 + 1];
    num initial_wave[4 + 1];
    num initial[3 + 1];
    num weight[3 + 1];
    num impedance[4 + 1];
    num strength[1 + 1];
    num gain[4 + 1];
    const real *load;
} OF(laws);
