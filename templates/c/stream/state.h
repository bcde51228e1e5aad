/* state.h: what a stream of waves remembers, the members of name_state; part of NAME.h, and of tables.h.
 * Below the first empty line, as in stream.c. */

    name_real time;      /* since the current panel began, */
    name_real time_low;  /* and what is lost of that by rounding */
    name_real lost;      /* what polynomials have missed so far, on that panel of a window where it is most: squares of */
    name_real most;      /* parts of the most that one has; */
    name_real size;      /* and the largest wave that it is small against, */
    name_real due;       /* until there is one, what loads so far would make of it within a panel */
    int alarm;           /* whether step has returned 2 */
    int seen;            /* how many instants of the panel are past */
    int phase;           /* which panel of a window it is */
    int at[NAME_TRACKS]; /* where a wave has the current panel */
    name_real load[NAME_LOADS + 1];      /* the loads now, */
    name_real slope[NAME_LOADS + 1];     /* and how fast they change */
    name_real force[NAME_FORCES + 1];    /* what they make: forces, velocities of points that they move */
    name_real x[NAME_STATES + 1];        /* of joints at the end of the panel, without loads */
    name_real own[NAME_STATES + 1];      /* what loads have added since the panel began, up to now, */
    name_real moved[NAME_OWN_POINTS + 1]; /* the integral of that, */
    name_real recorded[NAME_OWN_POINTS + 1][NAME_DEGREE + 1]; /* and velocities at the panel's instants */
    name_real missed[NAME_PANELS];       /* squared: what polynomials have missed on a panel of all windows */
    name_real total[NAME_OUTPUTS];       /* integrals up to the panel */
    name_real waves[NAME_SLOTS][NAME_DEGREE + 1]; /* Chebyshev coefficients */
