/* work.h: what a model of a chain needs while it is built.
 * Generated files have what stands below the first empty line, with their scene's name. */

/* How many numbers a series of a wave has: zeros up to a whole vector follow. */
enum { NAME_ROW = NAME_DEGREE + 64 / sizeof(name_real) };

/* What is worked in while a model is built, and what nobody needs afterwards: waves in rings, states of joints at the
 * start and the end of a window, what acts on points and how states move on it, tables of bodies and of blocks, integrals,
 * loads. */
struct name_work {
    name_real waves[NAME_SLOTS][NAME_PANELS][NAME_ROW];
    name_real state[2][NAME_STATES + 1];
    name_real acting[NAME_PANELS][NAME_POINTS][NAME_ROW];
    name_real path[NAME_PANELS][NAME_STATES + 1][NAME_ROW];
    name_real body[NAME_PANELS][NAME_BODIES + 1][NAME_DEGREE + 2][4];
    name_real solver[NAME_PANELS][4][(NAME_DEGREE + 2) * NAME_SQUARES + 1];
    name_real edge[NAME_PANELS][2][NAME_SQUARES + 1];
    name_real inverse[NAME_ROW + 1];
    name_real total[NAME_HEARD + 1];
    name_real change[NAME_EVENTS + 1];
    name_real load[NAME_FORCES + 1][3];
    int since[NAME_FORCES + 1][2];
    name_real force[NAME_PANELS][NAME_FORCES + 1][3];
    name_real largest[NAME_OUTPUTS];
    name_real mean[NAME_OUTPUTS];
};
