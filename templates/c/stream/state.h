/* state.h: what a stream of waves remembers, the members of name_state; part of NAME.h, and of tables.h. */

    name_real time;        /* since the current panel began, */
    name_real time_low;    /* and what is lost of that by rounding; */
    name_real age;         /* and since the stream did */
    name_real lost_energy; /* what polynomials have missed so far: the root of an energy, */
    name_real lost_wave;   /* how large waves are that are wrong at once, */
    name_real lost_slope;  /* and how steep all others; velocities times roots of impedances */
    name_real rounded;     /* about how wrong rounding makes waves, */
    name_real misread;     /* and what is read of them so near to the end of a panel that it is read there */
    name_real size;        /* the largest wave that all this is small against, */
    name_real due;         /* or what loads that change on this panel make within one */
    int alarm;             /* whether step has returned 2 */
    int phase;             /* which panel of a window it is */
    int at[NAME_TRACKS];   /* where a wave has the current panel, */
    int turn[NAME_TRACKS]; /* and a breakpoint of it */
    int breakpoints;       /* how many have been in use at once, */
    int spare;             /* the first that is no longer, */
    int first_breakpoint[NAME_PANELS];              /* the first one of a panel, */
    int next_breakpoint[NAME_BREAKPOINTS + 1];      /* the one after each, negative for none, */
    int silent[NAME_BREAKPOINTS + 1];               /* for how many windows nothing was sent after it, */
    name_real place[NAME_BREAKPOINTS + 1];          /* and how long after the start of its panel it is */
    name_real load[NAME_LOADS + 1];                 /* the loads now, */
    name_real slope[NAME_LOADS + 1];                /* and how fast they change */
    name_real force[NAME_FORCES + 1];               /* integrals of loads: velocities of points that they move */
    name_real x[NAME_STATES + 1];                   /* of joints at the end of the panel */
    name_real total[NAME_OUTPUTS];                  /* integrals up to the panel */
    name_real largest[NAME_OUTPUTS];                /* of what was given out */
    name_real waves[NAME_SLOTS + NAME_BREAKPOINTS * NAME_ENTRIES][NAME_DEGREE + 1]; /* Chebyshev coefficients */
