/* state.h: what a march remembers; part of NAME.h, and of tables.h.
 * Below the first empty line, as in march.c. */

/* A march. Its owner keeps it; all of it is set by init. */
typedef struct name_state {
    int window;         /* the current one, -1 before the first */
    int half;           /* which half of `waves` is the current window's */
    int within;         /* 0 once what moves is beyond reach */
    int alarm;          /* whether advance has returned 1 */
    int event;          /* the next change of the scene's own loads */
    name_real leak;        /* what the polynomials have missed so far, */
    name_real size;        /* and the largest velocity or mean of a wave that it is small against */
    name_real rough;       /* the largest part of a load so far that its points do not resolve */
    name_real velocity[NAME_NODES]; /* of the bodies at the end of the window */
    name_real displacement[NAME_OUTPUTS]; /* at its start, and what else is an integral */
    name_real integral[NAME_SOURCES + 1]; /* of the loads given so far */
    name_real load[NAME_FORCES + 1][3]; /* the scene's own, in powers of the time since */
    int since[NAME_FORCES + 1][2]; /* that window and panel */
    /* Chebyshev coefficients of the waves that each node sends to the left, [0], and to the right, [1]; of loads, [2] */
    name_real waves[2][NAME_WAYS][NAME_PANELS][NAME_NODES + 2][NAME_DEGREE + 1];
} name_state;
