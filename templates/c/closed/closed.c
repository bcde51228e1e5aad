/* closed.c: sums of pulses. */
#include "library.h"
#include "tables.h"

/* The closed form: at tau = start + (little less than one ulp, `excess`) an output gains a pulse,
 *
 *     sum over its families of exp(-rate*w) * (coefficient[0] + coefficient[1]*w + ...),  w = tau - arrival,
 *
 * the increments of (4.9), (4.10), (4.12) with the waves of its rod, the loads and the output's own factors merged. */

static real exponential(real x)
{
    return sizeof(real) < sizeof(double) ? (real)expf((float)x) : (real)exp((double)x);
}

static real value(int output, real tau)
{
    real sum = 0;
    for (int pulse = first_pulse[output]; pulse < first_pulse[output + 1] && tau >= start[pulse]; ++pulse) {
        const real w = (tau - start[pulse]) + excess[pulse];
        for (int family = first_family[pulse]; family < first_family[pulse + 1]; ++family) {
            int power = first_power[family + 1] - 1;
            real polynomial = coefficient[power];
            while (power > first_power[family]) {
                --power;
                polynomial = polynomial * w + coefficient[power];
            }
            sum += polynomial * exponential(-(rate[family] * w));
        }
    }
    return sum;
}

int name_eval(real tau, real out[NAME_OUTPUTS])
{
    const int inside = tau >= 0 && tau <= NAME_TAU_MAX;
    for (int output = 0; output < NAME_OUTPUTS; ++output) {
        out[output] = inside ? value(output, tau) : not_a_number();
    }
    return !inside;
}

int name_sample(real tau0, real dtau, size_t count, real *out)
{
    int outside = 0;
    for (size_t k = 0; k < count; ++k) {
        /* volatile: the product is rounded by itself, so that every compiler means the same tau_k */
        const volatile real step = (real)k * dtau;
        const real tau = tau0 + step;
        real at_tau[NAME_OUTPUTS];
        outside |= name_eval(tau, at_tau);
        for (size_t output = 0; output < NAME_OUTPUTS; ++output) {
            out[output * count + k] = at_tau[output];
        }
    }
    return outside;
}
