/* steps.h: any steps of a stream, whichever way it began, and what holds of them. What is refused changes nothing, outputs
 * without an alarm are numbers, an alarm stays, and a copy goes on as the stream does. */
#include "fuzz.h"

enum { MOST = 48 };

#if defined(NAME_SPACING)
#define STEP NAME_SPACING
#define ANY_STEP 0
#else
#define STEP NAME_PANEL
#define ANY_STEP 1
#endif

/* A step; not one of a thousand panels and more, which takes its time. */
static name_real some_step(told *t)
{
    name_real dtau;
    switch (choice(t, 4)) {
    case 0:
        return 0;
    case 1:
        return STEP;
    case 2:
        return STEP * (name_real)choice(t, 256) / 64;
    default:
        dtau = number(t);
        return dtau > 8 * STEP && dtau < 2000000 * STEP ? 8 * STEP : dtau;
    }
}

/* Until no bytes are left; a stream whose parameters were `refused` gives nothing. */
static void go_on(told *t, name_state *state, int refused)
{
    static name_state before, copy;
    int alarm = 0;
    for (int turn = 0; turn < MOST && t->left > 0; ++turn) {
        const name_real dtau = some_step(t);
        const int known = choice(t, 2);
        name_real load[NAME_LOADS + 1], out[NAME_OUTPUTS], other[NAME_OUTPUTS];
        int status;
        for (size_t j = 0; j < NAME_LOADS; ++j) {
            load[j] = known ? (name_real)(choice(t, 256) - 128) / 16 : number(t);
        }
        if (!known && choice(t, 32) == 1) {
            name_init(state);
            alarm = 0;
        }
        memcpy(&before, state, sizeof *state);
        memcpy(&copy, state, sizeof *state);
        status = name_step(state, dtau, load, out);
        MUST(name_step(&copy, dtau, load, other) == status);
        MUST(memcmp(&copy, state, sizeof *state) == 0);
        MUST(memcmp(out, other, sizeof out) == 0);
        MUST(status >= 0 && status <= 2);
        MUST(all_finite(load, NAME_LOADS) || status == 1);
        MUST(dtau >= 0 || status == 1);
        MUST(ANY_STEP || dtau > 0 || status == 1);
        MUST(dtau < 2000000 * STEP || status == 1);
        if (status == 1) {
            MUST(all_nan(out, NAME_OUTPUTS));
            MUST(memcmp(&before, state, sizeof *state) == 0);
            MUST(!all_finite(load, NAME_LOADS) || !(dtau >= STEP && dtau <= STEP));
            continue;
        }
        MUST(status == 2 || (!refused && all_finite(out, NAME_OUTPUTS)));
        MUST(!refused || all_nan(out, NAME_OUTPUTS));
#if ANY_STEP
        MUST(status >= alarm);
        alarm = status;
        MUST(status == 2 || (name_lost(state) >= 0));
#else
        MUST((status == 2) == !all_finite(out, NAME_OUTPUTS));
        (void)alarm;
#endif
    }
}
