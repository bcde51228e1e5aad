/* batch.h: models of many sets of parameters of a chain side by side.
 * Generated files have what stands below the first empty line, with their scene's name. */
#include "../runtime/wide.h"

/* Models of up to NAME_WIDTH sets. Plain data, yours; only `build_batch` writes into it. It is read and written sooner
 * where it begins at a multiple of 64 bytes. */
typedef struct {
    name_wide estimate;
    name_wide series[NAME_WINDOWS * NAME_STRANDS * (NAME_DEGREE + 2)];
    /* for `build_batch` alone, as in a model */
    name_wide waves[NAME_SLOTS][NAME_PANELS][NAME_ROW];
    name_wide state[2][NAME_STATES + 1];
    name_wide acting[NAME_PANELS][NAME_POINTS][NAME_ROW];
    name_wide path[NAME_PANELS][NAME_STATES + 1][NAME_ROW];
    name_wide solver[NAME_PANELS][4][(NAME_DEGREE + 2) * NAME_SQUARES + 1];
    name_wide edge[NAME_PANELS][2][NAME_SQUARES + 1];
    name_wide total[NAME_HEARD + 1];
    name_wide change[NAME_EVENTS + 1];
    name_wide load[NAME_FORCES + 1][3];
    name_wide force[NAME_PANELS][NAME_FORCES + 1][3];
    name_wide largest[NAME_OUTPUTS];
    name_wide mean[NAME_OUTPUTS];
    name_wide worth[NAME_OUTPUTS];
    name_wide work[NAME_DEGREE + 2];
    name_real inverse[NAME_ROW + 1];
    int since[NAME_FORCES + 1][2];
    /* of each set, as `build` returns it; of each window the degree, for all sets, and where its series begin */
    int status[NAME_WIDTH];
    int degree[NAME_WINDOWS];
    size_t place[NAME_WINDOWS];
} name_batch;
