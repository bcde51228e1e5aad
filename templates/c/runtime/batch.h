/* batch.h: models of many sets of parameters of a chain side by side.
 * Generated files have what stands below the first empty line, with their scene's name. */
#include "wide.h"

/* What it takes to build a set. */
typedef struct {
    name_real waves[NAME_SLOTS][NAME_PANELS][NAME_ROW];
    name_real state[2][NAME_STATES + 1];
    name_real acting[NAME_PANELS][NAME_POINTS][NAME_ROW];
    name_real path[NAME_PANELS][NAME_STATES + 1][NAME_ROW];
    name_real body[NAME_PANELS][NAME_BODIES + 1][NAME_DEGREE + 2][4];
    name_real solver[NAME_PANELS][4][(NAME_DEGREE + 2) * NAME_SQUARES + 1];
    name_real edge[NAME_PANELS][2][NAME_SQUARES + 1];
    name_real total[NAME_HEARD + 1];
    name_real change[NAME_EVENTS + 1];
    name_real load[NAME_FORCES + 1][3];
    name_real force[NAME_PANELS][NAME_FORCES + 1][3];
    name_real largest[NAME_OUTPUTS];
    name_real mean[NAME_OUTPUTS];
    name_real worth[NAME_OUTPUTS];
    name_real sum[NAME_DEGREE + 2];
} name_set;

/* Models of up to NAME_WIDTH sets. Plain data, yours; only `build_batch` writes into it. It is read and written sooner
 * where it begins at a multiple of 64 bytes. */
struct name_batch {
    name_real series[NAME_WINDOWS * NAME_STRANDS * (NAME_DEGREE + 2)][NAME_WIDTH];
    /* for `build_batch` alone: as many sets side by side as a vector holds */
    name_set work[NAME_WIDTH];
    name_real inverse[NAME_ROW + 1];
    int since[NAME_FORCES + 1][2];
    /* of each set the estimate, and what `build` returns; of each window the degree, for all sets, and where its series
     * begin */
    name_real estimate[NAME_WIDTH];
    int status[NAME_WIDTH];
    int degree[NAME_WINDOWS];
    size_t place[NAME_WINDOWS];
};
