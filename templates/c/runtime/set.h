/* set.h: what models are built in: for one set of parameters, and for a set in each lane of a vector (`num`). */

/* The largest value and mean of each output so far, and the mean from which on it is evaluated again. */
typedef struct {
    num largest[NAME_OUTPUTS];
    num mean[NAME_OUTPUTS];
    num threshold[NAME_OUTPUTS];
} OF(extremes);

/* Waves in rings; states of joints at the start and the end of a window, and on it; integrals; changes of loads, loads, and
 * their series on the panels of a window. */
typedef struct {
    num waves[NAME_SLOTS][NAME_PANELS][NAME_ROW];
    num state[2][NAME_STATES + 1];
    num path[NAME_PANELS][NAME_STATES + 1][NAME_ROW];
    num total[NAME_GAINS + 1];
    num change[NAME_EVENTS + 1];
    num load[NAME_FORCES + 1][3];
    num force[NAME_PANELS][NAME_FORCES + 1][3];
    OF(extremes) extremes;
} OF(march_state);

/* Tables of bodies and of blocks, as march.c has them. */
typedef struct {
    num body[NAME_PANELS][NAME_BODIES + 1][NAME_DEGREE + 2][3];
    num drive[NAME_BODIES + 1];
    num solver[NAME_PANELS][4][(NAME_DEGREE + 2) * NAME_SQUARES + 1];
    num edge[NAME_PANELS][2][NAME_SQUARES + 1];
} OF(march_tables);
