/* lanes.c: the march that follows is of many sets of parameters, a set in each lane of a vector. */
#include "model.c"

/* Bytes of vectors: where they have 16, clang keeps two registers side by side in one, which hides what joints wait for; on
 * aarch64 two bodies side by side hide as much, and would need more registers than there are. */
#if defined(__clang__) && VECTOR == 16 && !defined(__aarch64__)
#define WIDE 32
#else
#define WIDE VECTOR
#endif

#if VECTOR > 0
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

enum { SETS = sizeof(wide) / sizeof(real), parts_batch = NAME_WIDTH / SETS, lanes_in_all_batch = NAME_WIDTH };

/* `most` grows to the magnitude of x */
static void enlarge_batch(wide *most, const wide *x)
{
    const wide size = MAGNITUDES(*x);
    const mask more = size > *most;
    *most = CHOSEN(more, size, *most);
}

static void add_magnitude_batch(wide *sum, const wide *x)
{
    *sum += MAGNITUDES(*x);
}

/* Whether a test holds in some set. */
static int in_some(const mask *test)
{
#if VECTOR > 0
    typedef long long words __attribute__((vector_size(WIDE)));
    const words all = (words)*test;
    long long found = 0;
    for (size_t k = 0; k < sizeof all / sizeof found; ++k) {
        found |= all[k];
    }
    return found != 0;
#else
    return *test;
#endif
}

/* Of series with a set in each lane a pack is one number. */
typedef wide pack_batch;
enum { packed_batch = 1 };

#define num wide
#define OF(name) name##_batch
#define PICK CHOSEN
#define SIZE_OF(x) MAGNITUDES(x)
#define SIZES_OF(x) MAGNITUDES(x)
#define TOTAL_OF(x) (x)
#define ZERO none
#define NOTHING none
#define TEST mask
#define SOME(test) in_some(&(test))
#define LANE(x, set) AT((x)[(set) / SETS], (set) % SETS)
