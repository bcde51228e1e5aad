/* model.h: what a built model keeps, as the members of a struct. */

    int built;                  /* 1, or 0 where `build` refused */
    int degree[NAME_WINDOWS];   /* of the polynomials of each window */
    size_t place[NAME_WINDOWS]; /* where in `series` those of a window begin */
    name_real estimate;
    name_real series[NAME_SERIES];
