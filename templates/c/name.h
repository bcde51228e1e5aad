/* name.h: stands for the header that is generated for a scene called `name`, where its C is read by itself.
 * With SINGLE defined its numbers are floats.
 * Of each file here generated C has what is below the first empty line, under the scene's name; above that a file includes
 * those whose text stands above its own. */
#include <stddef.h>

#ifdef SINGLE
typedef float name_real;
#else
typedef double name_real;
#endif

enum { NAME_OUTPUTS = 2 };

#define NAME_TAU_MAX ((name_real)8)

int name_eval(name_real tau, name_real out[NAME_OUTPUTS]);
int name_sample(name_real tau0, name_real dtau, size_t count, name_real *out);
