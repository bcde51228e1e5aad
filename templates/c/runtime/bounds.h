/* bounds.h: what programs with proved bounds declare. */

/* As build, and proved: no output is wrong by more than bound[output] times its largest value on [0, TAU_MAX], whatever
 * its parameters. It is pessimistic by a few digits, and infinite where it leaves nothing. It holds for what a compiler
 * makes of this without -ffast-math; parameters are taken as the numbers that they are. */
int name_error_bound(name_model *model, const name_parameters *parameters, name_real *bound);

/* The same in memory of yours, as build_with. */
int name_error_bound_with(name_work *work, name_model *model, const name_parameters *parameters, name_real *bound);
