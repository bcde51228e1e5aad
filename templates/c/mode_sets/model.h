/* model.h: what a model and a state consist of; part of NAME.h, and of tables.h. */

/* What oscillators do in a time: the matrix of displacement and velocity, and the displacements that a force of 1, and
 * one that grows by 1 in a unit of tau, cause from rest. */
typedef struct name_turns {
    name_real p11[NAME_MODES];
    name_real p12[NAME_MODES];
    name_real p21[NAME_MODES];
    name_real p22[NAME_MODES];
    name_real one[NAME_MODES];
    name_real two[NAME_MODES];
} name_turns;

/* A model of a set of parameters. Plain data, yours: copy it, keep as many as you like; only `build` writes into it. */
typedef struct name_model {
    int status;
    name_real estimate;
    name_real frequency[NAME_MODES]; /* per unit of tau, */
    name_real damping[NAME_MODES];   /* the ratios, */
    name_real push[NAME_LOADS][NAME_MODES]; /* and the shares in loads */
    name_turns half; /* of half a step */
    name_real moved[NAME_MODES][NAME_FILLED];  /* what displacements, */
    name_real moving[NAME_MODES][NAME_FILLED]; /* velocities, */
    name_real direct[NAME_LOADS][3][NAME_FILLED]; /* loads and their two integrals count in outputs */
    name_real factor[NAME_AMPLITUDES]; /* what samples are multiplied by */
} name_model;

/* How far modes are out at an instant, and how fast; the loads, their integrals, and the integrals of these. */
typedef struct name_motion {
    name_real y[NAME_MODES];
    name_real v[NAME_MODES];
    name_real load[NAME_LOADS];
    name_real once[NAME_LOADS];
    name_real twice[NAME_LOADS];
} name_motion;
