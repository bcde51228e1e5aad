/* library.h: what a closed form needs of the C library, exp and expf, before all else that stands in its C. */

#include <math.h>
