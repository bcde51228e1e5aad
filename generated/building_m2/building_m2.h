/* building_m2: made by wavesym, command: wavesym generate building_m2.toml
 *
 *   building, as far as the light cone of the outputs reaches
 *   base = force
 *   kappa_0 = 1/4, kappa_1 = 3/5, kappa_2 = 1/5
 *   acceleration of the base: 1 a at 0, -2/3 b at 0, 3/2 a at 3, 1/3 b at 3, 1/2 a at 6, 1/3 b at 6
 *   until = 12, tolerance = 1e-08
 *
 * Evaluator: closed, 69 pulses, bound 1e-11, takes longer; pieces, degree 0..6, 15 KiB, bound 9.4e-09
 * Everything is dimensionless: x in rod lengths, tau = c t / l, strain positive in tension.
 *
 * output           proved largest error / largest value
 *   strain@0.5             9.4e-09
 *   strain@1.5             8.2e-09
 *   velocity@0.5           9.4e-09
 *   velocity@1.5           9.3e-09
 *   displacement@0.5       7.6e-09
 *   displacement@1.5       9.1e-09
 */
#ifndef BUILDING_M2_H
#define BUILDING_M2_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of what is declared here, and the SHA-256 of the scene in canonical JSON: that of building_m2.json. */
#define BUILDING_M2_API_VERSION 1
#define BUILDING_M2_SCENE_SHA256 "6217eeb7a4044eddf817e79a73b7b70f5ccf68c9191d85c831b684ae171fdae0"

enum { BUILDING_M2_OUTPUTS = 6 };

/* The outputs by name: strains, velocities, displacements, each as listed in the scene. */
enum {
    BUILDING_M2_STRAIN_0_5 = 0,
    BUILDING_M2_STRAIN_1_5 = 1,
    BUILDING_M2_VELOCITY_0_5 = 2,
    BUILDING_M2_VELOCITY_1_5 = 3,
    BUILDING_M2_DISPLACEMENT_0_5 = 4,
    BUILDING_M2_DISPLACEMENT_1_5 = 5
};

/* The last tau. */
#define BUILDING_M2_TAU_MAX 12.0

/* Proved: largest error of any output relative to its largest value on [0, TAU_MAX].
 * Holds with and without contraction of a*b + c, for round-to-nearest arithmetic and an exp within 2 ulp;
 * not under -ffast-math. */
#define BUILDING_M2_ERROR_BOUND 9.4e-09

extern const char building_m2_output_name[BUILDING_M2_OUTPUTS][17];

/* All outputs at tau; at a jump the values to the right of it.
 * Returns 0, or 1 with out all NaN where tau is negative, beyond TAU_MAX or NaN. */
int building_m2_eval(double tau, double out[BUILDING_M2_OUTPUTS]);

/* Outputs at tau_k = tau0 + k*dtau, k = 0 ... count-1, each of the two operations rounded:
 * out[output*count + k]. Returns 0, or 1 where any tau_k was out of range; those values are NaN, the others right. */
int building_m2_sample(double tau0, double dtau, size_t count, double *out);

#ifdef __cplusplus
}
#endif

#endif
