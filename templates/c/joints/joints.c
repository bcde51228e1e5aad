/* joints.c: where the numbers of joints and waves of a chain are, under parameters that come at run time.
 * Plain C of a program of a scene called `name`. Generated files have their scene's name for it, and what stands below
 * the first empty line. */
#include "tables.h"
#define NAME_MARCHED
#include "../runtime/series.c"

/* The matrices of a joint for each degree, and two more: x_k = SOLVE r_k + DOWN y_(k+1) - DOWN x_(k-1), FIRST and LAST sum
 * to the state at both ends; START and END belong to x_0. */
enum { SOLVE = 0, DOWN = 1, FIRST = 2, LAST = 3, START = 0, END = 1 };

/* How many numbers of a wave follow its series: zeros. */
enum { SPARE = NAME_ROW - NAME_DEGREE };

/* Where a track has what it had so many windows ago, at most as many as it has steps. */
static int slot(int track, int window, int ago)
{
    const int turn = steps[track] + 1;
    return ring[track] + (window + turn - ago) % turn;
}

/* Of a chain an output that is 0, though it need not be, is taken for one of which rounding has left nothing. */
static int reached(const laws *law, int output)
{
    (void)law;
    (void)output;
    return 1;
}

static int states_of(int joint)
{
    return first_state[joint + 1] - first_state[joint];
}

static int points_of(int joint)
{
    return first_point[joint + 1] - first_point[joint];
}

/* Where the matrices of a joint begin, of those of a degree. */
static size_t square_at(int joint, int k)
{
    return (size_t)k * NAME_SQUARES + (size_t)at_rates[joint];
}

/* `most` grows to the magnitude of x */
static void enlarge(real *most, const real *x)
{
    *most = larger(*most, *x);
}

static void add_magnitude(real *sum, const real *x)
{
    *sum += magnitude(*x);
}

/* The march follows, of one set of parameters. */
#define num real
#define OF(name) name
#define PICK(test, one, other) ((test) ? (one) : (other))
#define SIZE(x) magnitude(x)
#define ZERO ((real)0)
