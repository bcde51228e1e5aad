/* march.c: a march that is driven by hand, under its own loads and any others, and read anywhere. What is refused changes
 * nothing, what is lost stays lost, and what can be read is a number. */
#include "fuzz.h"

#include <limits.h>

enum { MOST = 48 };

static void some_loads(told *t, name_real *loads)
{
    const int kind = choice(t, 4);
    const name_real first = number(t);
    for (size_t k = 0; k < NAME_SOURCES * NAME_POINTS; ++k) {
        loads[k] = kind == 0 || (kind == 1 && k > 0) ? first : kind == 1 ? (name_real)0 : number(t);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    told t = {bytes, count};
    static name_state state, before;
    name_real *const loads = room(NAME_SOURCES * NAME_POINTS);
    int alarm = 0, moderate = 1;
    name_init(&state);
    for (int turn = 0; turn < MOST && t.left > 0; ++turn) {
        const int what = choice(&t, 16);
        name_real out[NAME_OUTPUTS];
        int status, given = 1;
        if (what == 0) {
            name_init(&state);
            alarm = 0;
            moderate = 1;
        }
        if (what == 1) {
            state.window = INT_MAX - choice(&t, 4); /* leap over what would take years */
        }
        for (size_t k = 0; k < NAME_SOURCES * NAME_POINTS; ++k) {
            loads[k] = 0;
        }
        if (what % 2) {
            some_loads(&t, loads);
            given = all_finite(loads, NAME_SOURCES * NAME_POINTS);
            for (size_t k = 0; k < NAME_SOURCES * NAME_POINTS; ++k) {
                moderate &= size_of(loads[k]) < (single ? (name_real)1e6 : (name_real)1e60);
            }
        }
        memcpy(&before, &state, sizeof state);
        status = name_advance(&state, what % 2 ? loads : NULL);
        MUST(status >= 0 && status <= 2);
        MUST(given || status == 2);
        MUST(state.within || status == 2);
        if (!given || (status == 2 && (state.within || !before.within))) {
            MUST(memcmp(&before, &state, sizeof state) == 0);
        }
        if (status < 2) {
            MUST(state.window == before.window + 1);
            MUST(status >= alarm);
            alarm = status;
        }
        if (state.within && state.window >= 0) {
            const name_real tau = (name_real)state.window + (name_real)choice(&t, 256) / 256;
            const int outside = name_read(&state, tau, out);
            MUST(outside ? all_nan(out, NAME_OUTPUTS) : all_finite(out, NAME_OUTPUTS));
            MUST(!outside || tau > NAME_TAU_MAX || tau - (name_real)state.window >= 1);
            MUST(!moderate || finite(name_energy(&state)));
        }
        if (what == 2) {
            const name_real tau = number(&t);
            const int outside = name_read(&state, tau, out);
            MUST(outside ? all_nan(out, NAME_OUTPUTS) : all_finite(out, NAME_OUTPUTS));
            MUST(outside || (tau >= (name_real)state.window && tau < (name_real)state.window + 1));
        }
    }
    free(loads);
    return 0;
}
