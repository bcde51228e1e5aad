/* model.h: what a built model keeps, and what it needs while it is built.
 * Generated files have what stands below the first empty line, with their scene's name. */

/* How many numbers a wave has: a series, and zeros up to a whole vector and two more. */
enum { NAME_ROW = NAME_DEGREE + 64 / sizeof(name_real) + 2 };

/* A model of a set of parameters. Plain data, yours: copy it, keep as many as you like; only `build` writes into it. */
typedef struct {
    int built;                  /* 1, or 0 where `build` refused */
    int degree[NAME_WINDOWS];   /* of the polynomials of each window */
    size_t place[NAME_WINDOWS]; /* where in `series` those of a window begin */
    name_real estimate;
    name_real series[NAME_WINDOWS * NAME_STRANDS * (NAME_DEGREE + 2)];
    /* for `build` alone: waves on two windows, velocities at their start and end, tables of bodies, integrals, loads */
    name_real waves[2][3][NAME_PANELS][NAME_NODES + 2][NAME_ROW];
    name_real velocity[2][NAME_NODES];
    name_real table[NAME_PANELS * NAME_NODES][3][NAME_DEGREE + 2];
    name_real edge[NAME_PANELS * NAME_NODES][3];
    int row[NAME_PANELS * NAME_NODES];
    name_real inverse[NAME_ROW + 1];
    name_real total[NAME_HEARD + 1];
    name_real change[NAME_EVENTS + 1];
    name_real load[NAME_FORCES + 1][3];
    int since[NAME_FORCES + 1][2];
    name_real force[NAME_PANELS][NAME_FORCES + 1][3];
    name_real largest[NAME_OUTPUTS];
    name_real mean[NAME_OUTPUTS];
} name_model;

/* A model with its derivatives by every parameter, in the order of the parameters: their series lie as the model's. */
typedef struct {
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
    name_real waves[NAME_LANES][2][3][NAME_PANELS][NAME_NODES + 2][NAME_ROW];
    name_real velocity[NAME_LANES][2][NAME_NODES];
    name_real total[NAME_LANES][NAME_HEARD + 1];
    name_real change[NAME_LANES][NAME_EVENTS + 1];
    name_real load[NAME_LANES][NAME_FORCES + 1][3];
    int since[NAME_LANES][NAME_FORCES + 1][2];
    name_real force[NAME_LANES][NAME_PANELS][NAME_FORCES + 1][3];
} name_tangent;
