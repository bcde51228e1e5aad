/* drive_m1: made by wavesym, command: wavesym generate drive_m1.toml
 *
 *   drive, as far as the light cone of the outputs reaches
 *   kappa_1 = 1
 *   inertia_1 = 1, inertia_2 = 2
 *   torque on disc 1: 1 M1 at 0, -1 M1 at 4
 *   torque on disc 2: 1 M2 at 0, -1 M2 at 4
 *   until = 10, tolerance = 1e-06
 *
 * Evaluator: closed, 50 pulses, bound 6e-09, takes longer; pieces, degree 0..5, 11 KiB, bound 8.9e-07
 * Everything is dimensionless: x in rod lengths, tau = c t / l, strain positive in tension.
 * Moments on discs count along positive rotation, but that on the last disc against it; those in shafts are
 * positive where they turn what is left of them forward, as strains are.
 *
 * output           proved largest error / largest value
 *   strain@0               8.9e-07
 *   strain@0.5             7.7e-07
 *   strain@1               8.9e-07
 *   displacement@0         8.4e-07
 *   displacement@1         7.5e-07
 */
#ifndef DRIVE_M1_H
#define DRIVE_M1_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of what is declared here, and the SHA-256 of the scene in canonical JSON: that of drive_m1.json. */
#define DRIVE_M1_API_VERSION 1
#define DRIVE_M1_SCENE_SHA256 "2da5d3741e3b87516d6b7b00204d91938546dc4a5497000fa03218649a2f366d"

enum { DRIVE_M1_OUTPUTS = 5 };

/* The outputs by name: strains, velocities, displacements, each as listed in the scene. */
enum {
    DRIVE_M1_STRAIN_0 = 0,
    DRIVE_M1_STRAIN_0_5 = 1,
    DRIVE_M1_STRAIN_1 = 2,
    DRIVE_M1_DISPLACEMENT_0 = 3,
    DRIVE_M1_DISPLACEMENT_1 = 4
};

/* The last tau. */
#define DRIVE_M1_TAU_MAX 10.0

/* Proved: largest error of any output relative to its largest value on [0, TAU_MAX].
 * Holds with and without contraction of a*b + c, for round-to-nearest arithmetic and an exp within 2 ulp;
 * not under -ffast-math. */
#define DRIVE_M1_ERROR_BOUND 8.9e-07

extern const char drive_m1_output_name[DRIVE_M1_OUTPUTS][15];

/* All outputs at tau; at a jump the values to the right of it.
 * Returns 0, or 1 with out all NaN where tau is negative, beyond TAU_MAX or NaN. */
int drive_m1_eval(double tau, double out[DRIVE_M1_OUTPUTS]);

/* Outputs at tau_k = tau0 + k*dtau, k = 0 ... count-1, each of the two operations rounded:
 * out[output*count + k]. Returns 0, or 1 where any tau_k was out of range; those values are NaN, the others right. */
int drive_m1_sample(double tau0, double dtau, size_t count, double *out);

#ifdef __cplusplus
}
#endif

#endif
