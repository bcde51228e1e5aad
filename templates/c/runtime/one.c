/* one.c: the march that follows is of one set of parameters. */
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

/* As many numbers of a series as are taken at once. */
typedef slice pack;
enum { packed = LANES };
static const pack nothing = {0};

/* Lanes from `half` on are added to those before, of twice as many. */
WITHIN void fold(real *sum, int half)
{
    UNROLLED
    for (int lane = 0; lane < half; ++lane) {
        if (half < LANES) {
            sum[lane] += sum[lane + half];
        }
    }
}

/* Of vectors up to 16 lanes, none of which goes through memory. */
static real total_of(const pack *x)
{
    real sum[LANES];
    UNROLLED
    for (int lane = 0; lane < LANES; ++lane) {
        sum[lane] = AT(*x, lane);
    }
    fold(sum, 8);
    fold(sum, 4);
    fold(sum, 2);
    fold(sum, 1);
    return sum[0];
}

#if VECTOR > 0
#define MAGNITUDE(x) ((pack)((choice)(x) & ~(choice)(-nothing)))
#else
#define MAGNITUDE(x) magnitude(x)
#endif

/* `parts` vectors hold `lanes_in_all` sets; a TEST is one of each set. */
enum { parts = 1, lanes_in_all = 1 };

#define num real
#define OF(name) name
#define PICK(test, one, other) ((test) ? (one) : (other))
#define SIZE_OF(x) magnitude(x)
#define SIZES_OF(x) MAGNITUDE(x)
#define TOTAL_OF(x) total_of(&(x))
#define ZERO ((real)0)
#define NOTHING nothing
#define TEST int
#define SOME(test) (test)
#define LANE(x, set) ((x)[set])
