/* collision_m4: made by wavesym, command: wavesym generate collision_m4.toml
 *
 *   collision, m = 4
 *   kappa = 1/10, 1/5
 *   velocity = 1, -1/2
 *   until = 10, tolerance = 1e-10
 *
 * Evaluator: closed: 10 outputs, bound 3.1e-13
 * Everything is dimensionless: x in rod lengths, tau = c t / l, strain positive in tension.
 *
 * output           proved largest error / largest value
 *   strain@1-              3.1e-13
 *   strain@2               3.9e-14
 *   strain@3+              1.3e-13
 *   displacement@0         1.3e-13
 *   displacement@1         9.9e-14
 *   displacement@1.5       1.6e-13
 *   displacement@2         4.1e-14
 *   displacement@2.5       1.4e-13
 *   displacement@3         1.1e-13
 *   displacement@4         1.3e-13
 */
#ifndef COLLISION_M4_H
#define COLLISION_M4_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { COLLISION_M4_OUTPUTS = 10 };

/* The last tau. */
#define COLLISION_M4_TAU_MAX 10.0

/* Proved: largest error of any output relative to its largest value on [0, TAU_MAX].
 * Holds with and without contraction of a*b + c, for round-to-nearest doubles and an exp within 2 ulp;
 * not under -ffast-math. */
#define COLLISION_M4_ERROR_BOUND 3.1e-13

/* Contacts open when their strain returns to zero; what they can reach after that is the formal continuation,
 * computed as if they stayed closed. */
#define COLLISION_M4_CONTACT_END_2 8.901878478505665 /* 8.9018784785056660529 */

extern const char *const collision_m4_output_name[COLLISION_M4_OUTPUTS];

/* All outputs at tau; at a jump the values to the right of it.
 * Returns 0, or 1 with out all NaN where tau is negative, beyond TAU_MAX or NaN. */
int collision_m4_eval(double tau, double out[COLLISION_M4_OUTPUTS]);

/* Outputs at tau_k = tau0 + k*dtau, k = 0 ... count-1, each of the two operations rounded to double:
 * out[output*count + k]. Returns 0, or 1 where any tau_k was out of range; those values are NaN, the others right. */
int collision_m4_sample(double tau0, double dtau, size_t count, double *out);

#ifdef __cplusplus
}
#endif

#endif
