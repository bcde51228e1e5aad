/* lanes.c: numbers of many sets of parameters, a set in each lane of a vector.
 * Stands above the text of a march in lanes in generated files, which
 * have what stands below the first empty line. */
#include "bounds.c"

/* All sets have one degree, the highest that one of them needs. A set that is refused goes along as another, or runs
 * wild in its own lane. A part is as many sets as a vector of WIDE bytes holds. */
typedef name_batch batch_of;

#if VECTOR
typedef real wide __attribute__((vector_size(WIDE), aligned(sizeof(real)), may_alias));
static const wide none = {0};
typedef __typeof__(none < none) mask;
#define MAGNITUDES(x) ((wide)((mask)(x) & ~(mask)(-none)))
#define CHOSEN(test, one, other) ((wide)(((test) & (mask)(one)) | (~(test) & (mask)(other))))
#else
typedef real wide;
static const wide none = 0;
typedef int mask;
#define MAGNITUDES(x) magnitude(x)
#define CHOSEN(test, one, other) ((test) ? (one) : (other))
#endif

enum { SETS = sizeof(wide) / sizeof(real), PARTS = NAME_WIDTH / SETS };

#define NOWHERE (none < none)
/* a number of a set, of those of all parts */
#define OF_SET(x, set) AT((x)[(set) / SETS], (set) % SETS)

/* `most` grows to the magnitude of x */
static void enlarge_batch(wide *most, const wide *x)
{
    const wide size = MAGNITUDES(*x);
    const mask more = size > *most;
    *most = CHOSEN(more, size, *most);
}

/* Whether a test holds in some set. */
static int in_some(const mask *test)
{
    int found = 0;
    (void)test;
    for (int lane = 0; lane < SETS; ++lane) {
        found |= AT(*test, lane) != 0;
    }
    return found;
}
