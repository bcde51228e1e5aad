/* peaks.h: what programs with peaks declare. */

/* Of each output the least value, its tau, the greatest value, its tau: out[output*4 ...], between samples, too, and of
 * values that a jump leaves behind. They are right to the last bits of what the model has. Returns 0, or 1 with all NaN for
 * a model that could not be built. */
int name_model_peaks(const name_model *model, name_real *out);
