/* frame: made by wavesym, command: wavesym generate frame.toml --runtime stiffness
 *
 *   building, as far as the light cone of the outputs reaches
 *   base = ground
 *   damping = 0
 *   storey = count 2, height 3.5 m, stiffness 600 MN/m, column_mass 10 t, floor_mass 350 t | height 3 m, stiffness
 *     500 MN/m, column_mass 20 t, floor_mass 300 t
 *   load at 0: spacing 0.1 s, samples 0, 1/4, -3/10, 1/5, -1/10, 0, unit g
 *   until = 3 s, tolerance = 0.0001
 *
 * Evaluator: modes with stiffness at run time, 16 of them, enough for the scene's own numbers and some more; errors are estimated
 * Time is tau, of which one is 0.004082482904638631 s; outputs have the units below.
 *
 *   strain@1-
 *   acceleration@3 [m/s^2]
 *   force@0 [N]
 *   drift@1 [mm]
 *   drift@3 [mm]
 *   relative@3 [mm]
 */
#ifndef FRAME_H
#define FRAME_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of what is declared here, and the SHA-256 of the scene in canonical JSON: that of frame.json. */
#define FRAME_API_VERSION 1
#define FRAME_SCENE_SHA256 "a28af6d50ac92991ff893c22ffd7a39bfb4b830f96da8c5c376591f2e6988391"

enum { FRAME_OUTPUTS = 6 };

/* The outputs by name: strains, velocities, displacements, accelerations, forces, drifts, relative displacements, each as listed in the scene. */
enum {
    FRAME_STRAIN_1_MINUS = 0,
    FRAME_ACCELERATION_3 = 1,
    FRAME_FORCE_0 = 2,
    FRAME_DRIFT_1 = 3,
    FRAME_DRIFT_3 = 4,
    FRAME_RELATIVE_3 = 5
};

extern const char frame_output_name[FRAME_OUTPUTS][15];

/* The last tau. */
#define FRAME_TAU_MAX 734.8469228349535

/* One tau in seconds. */
#define FRAME_SECONDS_PER_TAU 0.004082482904638631

/* The tolerance of the scene, and the time between two samples of its loads, in tau. */
#define FRAME_TOLERANCE 0.0001
#define FRAME_SPACING 1.4408763192842224

/* How many oscillators, loads, and parts of loads with a factor of their own there are. */
enum {
    FRAME_MODES = 16,
    FRAME_LOADS = 1,
    FRAME_AMPLITUDES = 1,
    FRAME_FILLED = 8 /* outputs, and zeros up to a multiple of 8 */
};

typedef struct frame_parameters frame_parameters;

/* How many numbers each field of the parameters has. */
enum {
    FRAME_STIFFNESS_COUNT = 3
};

/* The parameters. */
struct frame_parameters {
    /*
     * [0] stiffness of rod 1 [N/m]
     * [1] stiffness of rod 2 [N/m]
     * [2] stiffness of rod 3 [N/m]
     */
    double stiffness[FRAME_STIFFNESS_COUNT];
};

/* Those of the scene. */
extern const frame_parameters frame_defaults;

/* What oscillators do in a time: the matrix of displacement and velocity, and the displacements that a force of 1, and
 * one that grows by 1 in a unit of tau, cause from rest. */
typedef struct frame_turns {
    double p11[FRAME_MODES];
    double p12[FRAME_MODES];
    double p21[FRAME_MODES];
    double p22[FRAME_MODES];
    double one[FRAME_MODES];
    double two[FRAME_MODES];
} frame_turns;

/* A model of a set of parameters. Plain data, yours: copy it, keep as many as you like; only `build` writes into it. */
typedef struct frame_model {
    int status;
    double estimate;
    double frequency[FRAME_MODES]; /* per unit of tau, */
    double damping[FRAME_MODES];   /* the ratios, */
    double push[FRAME_LOADS][FRAME_MODES]; /* and the shares in loads */
    frame_turns half; /* of half a step */
    double moved[FRAME_MODES][FRAME_FILLED];  /* what displacements, */
    double moving[FRAME_MODES][FRAME_FILLED]; /* velocities, */
    double direct[FRAME_LOADS][3][FRAME_FILLED]; /* loads and their two integrals count in outputs */
    double factor[FRAME_AMPLITUDES]; /* what samples are multiplied by */
} frame_model;

/* How far modes are out at an instant, and how fast; the loads, their integrals, and the integrals of these. */
typedef struct frame_motion {
    double y[FRAME_MODES];
    double v[FRAME_MODES];
    double load[FRAME_LOADS];
    double once[FRAME_LOADS];
    double twice[FRAME_LOADS];
} frame_motion;

/* Find the modes of a set of parameters; then all can be read for tau from 0 to TAU_MAX.
 * Returns
 * 0;
 * 1 where a parameter is no finite number, is negative, or 0 where it has to be positive (all but loads and ratios of
 *   damping; those of a Rayleigh pair, too): then all values are NaN;
 * 2 where the estimate of the error under the scene's loads is above TOLERANCE, as MODES are too few for these parameters,
 *   or modes hardly to be told apart. Values can be read all the same. */
int frame_build(frame_model *model, const frame_parameters *parameters);

/* About the largest error of any output under the scene's loads relative to its largest value: an estimate, not proved,
 * usually ten times too large. NaN for parameters that were refused. */
double frame_error_estimate(const frame_model *model);

/* All outputs at tau, out[OUTPUTS]. Every call steps from rest to tau: `sample` steps once for all instants.
 * Returns 0, or 1 with out all NaN where tau is negative, beyond TAU_MAX or NaN, or parameters were refused. */
int frame_model_eval(const frame_model *model, double tau, double *out);

/* Outputs at tau_k = tau0 + k*dtau, k = 0 ... count-1, each of the two operations rounded:
 * out[output*count + k]. Returns 0, or 1 where any tau_k was out of range; those values are NaN, the others right. */
int frame_model_sample(
    const frame_model *model, double tau0, double dtau, size_t count, double *out);

#ifdef __cplusplus
}
#endif

#endif
