/* models.h: what every program with parameters at run time declares. */

typedef struct name_parameters name_parameters;
typedef struct name_work name_work;
typedef struct name_model name_model;

/* Make the model of a set of parameters, valid for all tau from 0 to TAU_MAX.
 * Returns 0; 1 where a parameter is no finite number, or not positive where it must be, or numbers overflow or
 * vanish; 2 where DEGREE is too low for these parameters. In the last two cases nothing can be read from the model: values
 * are NaN. */
int name_build(name_model *model, const name_parameters *parameters);

/* The same in memory of yours, which one model after the other can be built in, and which nobody needs afterwards. */
int name_build_with(name_work *work, name_model *model, const name_parameters *parameters);

/* About the largest error of any output relative to its largest value, with a margin: an estimate, not proved. Infinite
 * where of an output nothing may be left but rounding, as where large waves cancel; one that no wave reaches, or that is 0
 * whatever the parameters are, is exactly 0 and does not count. NaN for a model that could not be built. */
name_real name_error_estimate(const name_model *model);

/* All outputs at tau, out[OUTPUTS]; at a jump the values to the right of it.
 * Returns 0, or 1 with out all NaN where tau is negative, beyond TAU_MAX or NaN, or the model could not be built. */
int name_model_eval(const name_model *model, name_real tau, name_real *out);

/* Outputs at tau_k = tau0 + k*dtau, k = 0 ... count-1, each of the two operations rounded:
 * out[output*count + k]. Returns 0, or 1 where any tau_k was out of range; those values are NaN, the others right. */
int name_model_sample(const name_model *model, name_real tau0, name_real dtau, size_t count, name_real *out);
