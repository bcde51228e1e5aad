/* gradients.h: what programs with derivatives declare. */

typedef struct name_tangent name_tangent;

/* As build, with derivatives by all parameters. Degrees are those that derivatives need, too: where they are about DEGREE,
 * a set may be refused by one of the two alone. */
int name_build_tangent(name_tangent *tangent, const name_parameters *parameters);

/* About the largest error of a lane, 0 the values, then one for each parameter: of any output's derivative relative to the
 * largest value of that derivative, as error_estimate says it of values. NaN for a tangent that could not be built, and
 * for a lane that there is not. Found when it is asked for, as a few samples are. */
name_real name_tangent_estimate(const name_tangent *tangent, int lane);

/* As model_sample: out[(lane*OUTPUTS + output)*count + k], lane 0 the values, then one for each parameter, in the order
 * of the struct: LANES + 1 in all. */
int name_tangent_sample(const name_tangent *tangent, name_real tau0, name_real dtau, size_t count, name_real *out);
