/* data.h: data to compare models with. */

/* Data, so that the sum of squares of all misfits is taken from coefficients: with the series c of an output on a section
 * of a window, V c its values and y the data, |V c - y|^2 = |R c - z|^2 + rest. R is a triangle with weights. */
struct name_data {
    size_t place[NAME_WINDOWS * NAME_GROUPS]; /* where in `numbers` those of a group begin */
    int rows[NAME_WINDOWS * NAME_GROUPS];
    name_real *numbers; /* the caller's */
};
