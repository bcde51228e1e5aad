/* state.h: what a stream remembers; part of NAME.h, and of tables.h. */

/* A stream. Its owner keeps it; all of it is set by init. */
typedef struct name_state {
    name_real y[NAME_MODES]; /* how far each mode is out, */
    name_real v[NAME_MODES]; /* and how fast it moves */
    name_real load[NAME_LOADS];  /* the last samples, */
    name_real once[NAME_LOADS];  /* the integrals of the loads, */
    name_real twice[NAME_LOADS]; /* and the integrals of these */
} name_state;
