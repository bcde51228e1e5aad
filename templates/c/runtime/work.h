/* work.h: what a model needs while it is built.
 * Generated files have what stands below the first empty line, with their scene's name. */

/* How many numbers a wave has: a series, and zeros up to a whole vector and two more. */
enum { NAME_ROW = NAME_DEGREE + 64 / sizeof(name_real) + 2 };

/* What is worked in while a model is built, and what nobody needs afterwards: waves on two windows, velocities at their
 * start and end, tables of bodies, integrals, loads. */
struct name_work {
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
};
