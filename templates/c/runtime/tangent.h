/* tangent.h: a model of a chain with its derivatives.
 * Generated files have what stands below the first empty line, with their scene's name. */

/* A model with its derivatives by every parameter, in the order of the parameters: their series lie as the model's. */
struct name_tangent {
    name_model value;
    name_real series[NAME_LANES][NAME_WINDOWS * NAME_STRANDS * (NAME_DEGREE + 2)];
    /* for `tangent_estimate`: of values what they are wrong by, at last and on all windows together; what polynomials miss,
     * the largest velocity or mean of a wave (now and on the next window), and of what acts on derivatives */
    name_parameters parameters;
    name_real wrong[2];
    name_real missed[NAME_LANES];
    name_real size[NAME_LANES][2];
    name_real acts[NAME_LANES];
    /* for `build_tangent` alone */
    name_work work;
    name_real waves[NAME_LANES][NAME_SLOTS][NAME_PANELS][NAME_ROW];
    name_real state[NAME_LANES][2][NAME_STATES + 1];
    name_real total[NAME_LANES][NAME_HEARD + 1];
    name_real change[NAME_LANES][NAME_EVENTS + 1];
    name_real load[NAME_LANES][NAME_FORCES + 1][3];
    int since[NAME_LANES][NAME_FORCES + 1][2];
    name_real force[NAME_LANES][NAME_PANELS][NAME_FORCES + 1][3];
};
