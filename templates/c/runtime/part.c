/* lanes.c: the march of a chain follows, of many sets of parameters.
 * Plain C that stands below the text of runtime/lanes.c in generated files, which have what stands below the first empty
 * line. */
#include "lanes.c"
#include "laws.h"

/* What it takes to build the sets of a part: name_set of each of them. */
typedef struct {
    wide waves[NAME_SLOTS][NAME_PANELS][NAME_ROW];
    wide state[2][NAME_STATES + 1];
    wide acting[NAME_PANELS][NAME_POINTS][NAME_ROW];
    wide path[NAME_PANELS][NAME_STATES + 1][NAME_ROW];
    wide body[NAME_PANELS][NAME_BODIES + 1][NAME_DEGREE + 2][4];
    wide solver[NAME_PANELS][4][(NAME_DEGREE + 2) * NAME_SQUARES + 1];
    wide edge[NAME_PANELS][2][NAME_SQUARES + 1];
    wide total[NAME_HEARD + 1];
    wide change[NAME_EVENTS + 1];
    wide load[NAME_FORCES + 1][3];
    wide force[NAME_PANELS][NAME_FORCES + 1][3];
    wide largest[NAME_OUTPUTS];
    wide mean[NAME_OUTPUTS];
    wide worth[NAME_OUTPUTS];
    wide sum[NAME_DEGREE + 2];
} part_of;

typedef part_of work_of_batch;

static void add_magnitude_batch(wide *sum, const wide *x)
{
    *sum += MAGNITUDES(*x);
}

#define num wide
#define OF(name) name##_batch
#define PICK CHOSEN
#define SIZE(x) CHOSEN((x) < none, -(x), (x))
#define ZERO none
#define FUSED 1
