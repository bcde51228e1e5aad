/* values.c: `eval` and `sample` anywhere. They say what is out of range, give numbers elsewhere, and agree. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    told t = {bytes, count};
    const size_t samples = (size_t)choice(&t, 100);
    const name_real tau0 = number(&t);
    const name_real dtau = number(&t);
    name_real *const rows = room(NAME_OUTPUTS * samples);
    const int status = name_sample(tau0, dtau, samples, rows);
    int outside = 0;
    for (size_t k = 0; k < samples; ++k) {
        const volatile name_real step = (name_real)k * dtau;
        const name_real tau = tau0 + step;
        name_real out[NAME_OUTPUTS];
        const int refused = name_eval(tau, out);
        MUST(refused == !in_range(tau));
        MUST(refused ? all_nan(out, NAME_OUTPUTS) : all_finite(out, NAME_OUTPUTS));
        for (size_t output = 0; output < NAME_OUTPUTS; ++output) {
            const name_real value = rows[output * samples + k];
            MUST(refused ? value != value : value == out[output]);
        }
        outside |= refused;
    }
    MUST(status == outside);
    free(rows);
    return 0;
}
