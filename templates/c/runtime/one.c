/* one.c: the march that follows is of one set of parameters.
 * Plain C of a program of a scene called `name`; what stands below the first empty line. */
#include "reach.c"

static void enlarge(real *most, const real *x)
{
    *most = larger(*most, *x);
}

static void add_magnitude(real *sum, const real *x)
{
    *sum += magnitude(*x);
}

typedef name_extremes extremes;
typedef name_march_state march_state;
typedef name_march_tables march_tables;

/* `parts` vectors hold `lanes_in_all` sets; a TEST is one of each set. */
enum { parts = 1, lanes_in_all = 1 };

#define num real
#define OF(name) name
#define PICK(test, one, other) ((test) ? (one) : (other))
#define SIZE_OF(x) magnitude(x)
#define ZERO ((real)0)
#define TEST int
#define SOME(test) (test)
#define LANE(x, set) ((x)[set])
