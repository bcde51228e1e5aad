/* building_m2: made by wavesym, command: wavesym generate building_m2.toml
 *
 *   building, m = 2
 *   kappa = 1/4, 3/5, 1/5
 *   base = force
 *   unit loads: 1 a at 0, -2/3 b at 0, 3/2 a at 3, 1/3 b at 3, 1/2 a at 6, 1/3 b at 6
 *   until = 12, tolerance = 1e-08
 *
 * Evaluator: closed: 6 outputs, bound 9.7e-12
 * Everything is dimensionless: x in rod lengths, tau = c t / l, strain positive in tension.
 *
 * output           proved largest error / largest value
 *   strain@0.5             2.3e-13
 *   strain@1.5             8.8e-13
 *   velocity@0.5           2.2e-13
 *   velocity@1.5           1.2e-12
 *   displacement@0.5       3.9e-12
 *   displacement@1.5       9.7e-12
 */
#ifndef BUILDING_M2_H
#define BUILDING_M2_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { BUILDING_M2_OUTPUTS = 6 };

/* The last tau. */
#define BUILDING_M2_TAU_MAX 12.0

/* Proved: largest error of any output relative to its largest value on [0, TAU_MAX].
 * Holds with and without contraction of a*b + c, for round-to-nearest doubles and an exp within 2 ulp;
 * not under -ffast-math. */
#define BUILDING_M2_ERROR_BOUND 9.7e-12

extern const char *const building_m2_output_name[BUILDING_M2_OUTPUTS];

/* All outputs at tau; at a jump the values to the right of it.
 * Returns 0, or 1 with out all NaN where tau is negative, beyond TAU_MAX or NaN. */
int building_m2_eval(double tau, double out[BUILDING_M2_OUTPUTS]);

/* Outputs at tau_k = tau0 + k*dtau, k = 0 ... count-1, each of the two operations rounded to double:
 * out[output*count + k]. Returns 0, or 1 where any tau_k was out of range; those values are NaN, the others right. */
int building_m2_sample(double tau0, double dtau, size_t count, double *out);

#ifdef __cplusplus
}
#endif

#endif
