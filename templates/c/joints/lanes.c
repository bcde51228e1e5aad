/* lanes.c: the march of a chain follows, of many sets of parameters.
 * Plain C that stands below the text of runtime/lanes.c in generated files, which have what stands below the first empty
 * line. */
#include "bound.c"
#include "../runtime/bounds.c"
#include "../runtime/lanes.c"

typedef name_batch model_of_batch;

static void add_magnitude_batch(wide *sum, const wide *x)
{
    *sum += MAGNITUDE(*x);
}

#define num wide
#define OF(name) name##_batch
#define PICK CHOSEN
#define SIZE(x) CHOSEN((x) < none, -(x), (x))
#define ZERO none
