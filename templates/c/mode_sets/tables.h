/* tables.h: stands for what mode_sets.c.j2 writes above the text of these files, where they are read by themselves. */
/* Doubles alone. */
#undef SINGLE
#include "../name.h"

#include <float.h>
#include <math.h>

enum { NAME_MODES = 6, NAME_LOADS = 1, NAME_FILLED = 8, NAME_AMPLITUDES = 1 };

typedef struct name_parameters {
    name_real mass[1];
} name_parameters;

#include "model.h"

#include "../real.h"

#include "../vectors.h"

typedef name_model model;
typedef name_motion motion;
typedef struct name_state {
    name_model model;
    name_motion motion;
    name_real load[NAME_LOADS];
} stream;
typedef name_turns turns;

enum {
    MODES = NAME_MODES, /* oscillators, */
    FOUND = 6,          /* and those of them that are modes */
    LOADS = NAME_LOADS,
    OUTPUTS = NAME_OUTPUTS,
    GROUP = 8, /* outputs; no vector has more numbers */
    FILLED = NAME_FILLED /* outputs, and zeros up to a multiple of that */
};

enum {
    BARS = 1,
    ROWS = 1,   /* points that are free to move, tips first */
    PLACES = 2, /* these, then points whose motion is prescribed */
    LINKS = 0,
    MASSIVE = 0, /* whether there are masses and springs alone */
    FREE = 0,    /* whether nothing holds the chain */
    RATIOS = 1,
    FIRST_MODE = 0, /* those that a Rayleigh ratio is of, from 1 on; 0 where ratios are those of modes */
    SECOND_MODE = 0
};

enum {
    AMPLITUDES = NAME_AMPLITUDES,
    SAMPLES = 3, /* of each amplitude, SPACING apart, the first of them 0 */
    HALVES = 4,  /* steps of SPACING/2 within the horizon */
    MOVING = 1,  /* whether velocities of modes count in outputs, */
    SUMS = 1,    /* and integrals of loads */
    POINTS = 17, /* instants of a step that is looked at closely */
    BLOCK = 32,  /* steps whose values are kept together */
    TOGETHER = 8 /* motions that are read together; a BLOCK is a multiple of half of it */
};

/* Where numbers of each kind begin in value[]; SPRING holds a place to the ground. */
enum { ROD_STIFFNESS = 0, ROD_MASS = 1, MASS = 2, SPRING = 4, LINK = 6, RATIO = 6, FACTOR = 7, VALUES = 8 };

/* The numbers of a set without units, value[VALUES]. False where one is no number, or not positive where it has to be. */
int values_of(const name_parameters *p, real *value);

int name_model_eval(const model *m, real tau, real *out);
int name_model_sample(const model *m, real tau0, real dtau, size_t count, real *out);
int name_model_peaks(const model *m, real *out);
void name_init(stream *state);
int name_step(stream *state, real dtau, const real *load, real *out);
#ifdef STREAMED
int name_build(stream *state, const name_parameters *parameters);
real name_error_estimate(const stream *state);
#else
int name_build(model *m, const name_parameters *parameters);
real name_error_estimate(const model *m);
#endif

extern const real spacing;
extern const real tau_max;
extern const real tolerance;
/* A step outside of these is not the spacing, rounded. */
extern const real shortest;
extern const real longest;

/* The scene's numbers, dimensionless; where each parameter stands among them, and what 1 of it is in its unit. */
extern const real value_of_scene[];
extern const int parameter_value[];
extern const real parameter_unit[];

/* 2 where a parameter has to be positive, 1 where it may be 0, 0 where it may be any number. */
extern const int parameter_sign[];

/* The row that each row hangs on, -1 for none; the next row that hangs on the same one, in a circle. */
extern const int parent[];
extern const int beside[];

/* Bars: the rod that each is a part of, how much of its delay; its ends, their ratios, the row of its coupling. */
extern const int bar_rod[];
extern const real bar_part[];
extern const int bar_left[];
extern const int bar_right[];
extern const real bar_left_ratio[];
extern const real bar_right_ratio[];
extern const int bar_up[];

/* Springs between points. */
extern const int link_left[];
extern const int link_right[];
extern const real link_ratio[];
extern const int link_up[];

/* How far places move where nothing is strained; only of a chain that nothing holds. */
extern const real rigid[];

/* Outputs: how often each is differentiated in time; the power of 1/w^2 in its sum of squares; the bar and its end whose
 * slope it reads, or -1; whether the slope counts with the impedance; its factor; whether it is 0 whatever the numbers. */
extern const int output_order[];
extern const int output_power[];
extern const int output_bar[];
extern const int output_side[];
extern const int output_force[];
extern const real output_scale[];
extern const int is_zero[];
/* Of each GROUP of outputs whether velocities of modes count in them. */
extern const int group_moves[];
/* Otherwise it is a sum over places; where that of each output begins. */
extern const int first_term[];
extern const int term_place[];
extern const real term_weight[];

/* Loads: the place that each acts on, how strongly; amplitudes: the load that each is of, and its roughness. */
extern const int load_place[];
extern const real load_gain[];
extern const int amplitude_load[];
/* what 1 of it is in the unit of a stream */
extern const real load_unit[];
extern const real in_step[];
extern const real sample[];
