/* laws.h: stands for what runtime.c.j2 writes above the text of lanes.c, where that is read by itself. */
typedef struct {
    wide rates[5 + 1];
    wide pushed[5 + 1];
    wide shown[5 + 1];
    wide passed[5 + 1];
    wide push[4 + 1];
    wide initial_wave[4 + 1];
    wide initial[3 + 1];
    wide weight[3 + 1];
    wide impedance[4 + 1];
    wide strength[1 + 1];
    wide gain[4 + 1];
} laws_batch;

void spread(laws_batch *all, int lane, const laws *law);
