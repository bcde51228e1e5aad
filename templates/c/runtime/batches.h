/* batches.h: what programs that take many sets at once declare. */

typedef struct name_batch name_batch;

/* Make the models of up to WIDTH sets of parameters at once. Each set is what `build` makes of it but for rounding, and
 * for polynomials of a degree that is enough for all. What is not refused keeps to its estimate, whatever its neighbours
 * are. But the degree that a neighbour needs may be too high for a set whose numbers are powers of ten apart, as rounding
 * grows with it: such a set may have a status of 2 (seldom 1) here though `build` takes it alone. So ask again, alone, for
 * a set that is refused. Returns the largest status of the sets that were given; each has its own. */
int name_build_batch(name_batch *batch, const name_parameters *parameters, size_t sets);

/* A set of a batch as a model. Returns 0, or 1 where there is none. */
int name_batch_model(const name_batch *batch, int set, name_model *model);
