/* collision_m4: made by wavesym, command: wavesym generate collision_m4.toml
 *
 *   collision, as far as the light cone of the outputs reaches
 *   kappa_1 = 1/10, kappa_3 = 1/5
 *   velocity_1 = 1, velocity_3 = -1/2
 *   until = 10, tolerance = 1e-10
 *
 * Evaluator: closed, 65 pulses, bound 2.9e-13, takes longer; pieces, degree 0..6, 20 KiB, bound 9.3e-11
 * Everything is dimensionless: x in rod lengths, tau = c t / l, strain positive in tension.
 *
 * output           proved largest error / largest value
 *   strain@1-              7.6e-11
 *   strain@2               4.1e-11
 *   strain@3+              7.8e-11
 *   displacement@0         9.3e-11
 *   displacement@1         5.8e-11
 *   displacement@1.5       8.9e-11
 *   displacement@2         8.5e-11
 *   displacement@2.5       8.9e-11
 *   displacement@3         8.8e-11
 *   displacement@4         9.3e-11
 */
#ifndef COLLISION_M4_H
#define COLLISION_M4_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of what is declared here, and the SHA-256 of the scene in canonical JSON: that of collision_m4.json. */
#define COLLISION_M4_API_VERSION 1
#define COLLISION_M4_SCENE_SHA256 "0b7b463512c83fd4e5ac84a99aeaa12931aaa66e65100103a505bf6b2447b359"

enum { COLLISION_M4_OUTPUTS = 10 };

/* The outputs by name: strains, velocities, displacements, each as listed in the scene. */
enum {
    COLLISION_M4_STRAIN_1_MINUS = 0,
    COLLISION_M4_STRAIN_2 = 1,
    COLLISION_M4_STRAIN_3_PLUS = 2,
    COLLISION_M4_DISPLACEMENT_0 = 3,
    COLLISION_M4_DISPLACEMENT_1 = 4,
    COLLISION_M4_DISPLACEMENT_1_5 = 5,
    COLLISION_M4_DISPLACEMENT_2 = 6,
    COLLISION_M4_DISPLACEMENT_2_5 = 7,
    COLLISION_M4_DISPLACEMENT_3 = 8,
    COLLISION_M4_DISPLACEMENT_4 = 9
};

/* The last tau. */
#define COLLISION_M4_TAU_MAX 10.0

/* Proved: largest error of any output relative to its largest value on [0, TAU_MAX].
 * Holds with and without contraction of a*b + c, for round-to-nearest arithmetic and an exp within 2 ulp;
 * not under -ffast-math. */
#define COLLISION_M4_ERROR_BOUND 9.3e-11

/* Contacts open when their strain returns to zero; what they can reach after that is the formal continuation,
 * computed as if they stayed closed. */
#define COLLISION_M4_CONTACT_END_2 8.901878478505665 /* 8.9018784785056660529 */

extern const char collision_m4_output_name[COLLISION_M4_OUTPUTS][17];

/* All outputs at tau; at a jump the values to the right of it.
 * Returns 0, or 1 with out all NaN where tau is negative, beyond TAU_MAX or NaN. */
int collision_m4_eval(double tau, double out[COLLISION_M4_OUTPUTS]);

/* Outputs at tau_k = tau0 + k*dtau, k = 0 ... count-1, each of the two operations rounded:
 * out[output*count + k]. Returns 0, or 1 where any tau_k was out of range; those values are NaN, the others right. */
int collision_m4_sample(double tau0, double dtau, size_t count, double *out);

#ifdef __cplusplus
}
#endif

#endif
