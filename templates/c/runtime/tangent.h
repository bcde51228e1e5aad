/* tangent.h: a model of a chain with its derivatives. */

/* A model with its derivatives by every parameter, in the order of the parameters: their series lie as the model's. */
struct name_tangent {
    name_model value;
    name_real series[NAME_LANES][NAME_SERIES];
    /* for `tangent_estimate`: errors of values, at last and the sum of all windows; truncation errors of derivatives, the
     * largest velocity or mean of a wave (now and on the next window), and of what acts as laws change */
    name_parameters parameters;
    name_real error[2];
    name_real missed[NAME_LANES];
    name_real size[NAME_LANES][2];
    name_real acts[NAME_LANES];
    /* for `build_tangent` alone: what acts on a derivative as laws change, on points, on states, and on velocities */
    name_work work;
    name_march_state lane[NAME_LANES];
    name_real total[NAME_GAINS + 1]; /* integrals of values, while what is read of derivatives goes on from them */
    name_real acting[NAME_PANELS][NAME_POINTS][NAME_ROW];
    name_real moving[NAME_PANELS][NAME_STATES + 1][NAME_ROW];
    name_real shifted[NAME_PANELS][NAME_POINTS][NAME_ROW];
    int since[NAME_FORCES + 1][2];
};
