/* frame: made by wavesym; see frame.h.
 *
 * A chain of rods, masses and springs has the dynamic stiffness K(w). Its frequencies are found by counting the negative
 * pivots of K, so that none is missed; each mode is an oscillator, y'' + 2 damping frequency y' + frequency^2 y = push *
 * load, which is stepped exactly. Outputs are sums of modes, and of what loads do at once by all that are not found.
 */
#include "frame.h"

#include <float.h>
#include <math.h>

#if (defined(__FAST_MATH__) || defined(_M_FP_FAST) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || \
     defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)) && \
    !defined(FRAME_ALLOW_FAST_MATH)
#error "-ffast-math: bounds of errors no longer hold, nor NaN out of range (-D FRAME_ALLOW_FAST_MATH takes it all the same)"
#endif
#if defined(__FLT_EVAL_METHOD__) && (__FLT_EVAL_METHOD__ == 2 || __FLT_EVAL_METHOD__ < 0) && \
    !defined(FRAME_ALLOW_FAST_MATH)
#error "x87: bounds of errors no longer hold (-msse2 -mfpmath=sse helps; -D FRAME_ALLOW_FAST_MATH takes it all the same)"
#endif

typedef double real;

/* Without <math.h>, which not every machine has. */
static real not_a_number(void)
{
    const volatile real zero = 0;
    return zero / zero;
}

/* Bytes of the widest vectors that the compiler may use; 0 where it knows none, or FRAME_PLAIN asks for plain C. Wider ones
 * would go through memory. */
#if !defined(__GNUC__) || defined(__FRAMAC__) || defined(FRAME_PLAIN)
#define VECTOR 0
#elif defined(__AVX512F__)
#define VECTOR 64
#elif defined(__AVX__)
#define VECTOR 32
#elif defined(__SSE2__) || defined(__aarch64__) || defined(__VSX__) || defined(__wasm_simd128__)
#define VECTOR 16
#else
#define VECTOR 0
#endif

#if VECTOR
typedef real lanes __attribute__((vector_size(VECTOR)));
typedef real slice __attribute__((vector_size(VECTOR), aligned(sizeof(real)), may_alias)); /* anywhere in an array */
typedef __typeof__(*(const lanes *)0 < *(const lanes *)0) choice; /* of numbers: all their bits, or none */
#else
typedef real lanes;
typedef real slice;
#endif
enum { LANES = sizeof(slice) / sizeof(real) };

/* Of functions whose counts of vectors and outputs are known where they are called. */
#if defined(__clang__) && defined(__AVX512F__) && VECTOR
#define WITHIN static inline __attribute__((always_inline, min_vector_width(512))) /* else it takes halves of vectors */
#elif defined(__GNUC__) && !defined(__FRAMAC__)
#define WITHIN static inline __attribute__((always_inline))
#elif defined(_MSC_VER)
#define WITHIN static __forceinline
#else
#define WITHIN static
#endif

/* Loops over a few vectors are unrolled, so that they stay in registers; not where size counts more than speed. */
#if defined(__OPTIMIZE_SIZE__)
#define UNROLLED
#elif defined(__clang__)
#define UNROLLED _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#define UNROLLED _Pragma("GCC unroll 16")
#else
#define UNROLLED
#endif

typedef frame_model model;
typedef frame_motion motion;
typedef frame_turns turns;

const char frame_output_name[FRAME_OUTPUTS][15] = {
    "strain@1-",
    "acceleration@3",
    "force@0",
    "drift@1",
    "drift@3",
    "relative@3",
};

const frame_parameters frame_defaults = {
    {
        600000000.0, 600000000.0, 500000000.0
    },
};

enum {
    MODES = FRAME_MODES, /* oscillators, */
    FOUND = 16,          /* and those of them that are modes */
    LOADS = FRAME_LOADS,
    OUTPUTS = FRAME_OUTPUTS,
    GROUP = 8, /* outputs; no vector has more numbers */
    FILLED = FRAME_FILLED /* outputs, and zeros up to a multiple of that */
};

enum {
    BARS = 3,
    ROWS = 3,   /* points that are free to move, tips first */
    PLACES = 4, /* these, then points whose motion is prescribed */
    LINKS = 0,
    MASSIVE = 0, /* whether there are masses and springs alone */
    FREE = 0,    /* whether nothing holds the chain */
    RATIOS = 1,
    FIRST_MODE = 0, /* those that a Rayleigh ratio is of, from 1 on; 0 where ratios are those of modes */
    SECOND_MODE = 0
};

enum {
    AMPLITUDES = FRAME_AMPLITUDES,
    SAMPLES = 513, /* of each amplitude, SPACING apart, the first of them 0 */
    HALVES = 1020,  /* steps of SPACING/2 within the horizon */
    MOVING = 1,  /* whether velocities of modes count in outputs, */
    SUMS = 1,    /* and integrals of loads */
    POINTS = 17, /* instants of a step that is looked at closely */
    BLOCK = 32,  /* steps whose values are kept together */
    TOGETHER = 8 /* motions that are read together; a BLOCK is a multiple of half of it */
};

/* Where numbers of each kind begin in value[]; SPRING holds a place to the ground. */
enum { ROD_STIFFNESS = 0, ROD_MASS = 3, MASS = 6, SPRING = 10, LINK = 14, RATIO = 14, FACTOR = 15, VALUES = 16 };

static const real spacing = 1.4408763192842224;
static const real tau_max = 734.8469228349535;
static const real tolerance = 0.0001;

/* The scene's numbers, dimensionless; where each parameter stands among them, and what 1 of it is in its unit. */
static const real value_of_scene[] = {
    1.0, 1.0, 0.8333333333333333, 1.0, 1.0, 2.0, 30.0, 35.0, 35.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
};

static const int parameter_value[] = {
    0, 1, 2
};

static const real parameter_unit[] = {
    600000000.0, 600000000.0, 600000000.0
};

/* 2 where a parameter has to be positive, 1 where it may be 0, 0 where it may be any number. */
static const int parameter_sign[] = {
    2, 2, 2
};

/* The row that each row hangs on, -1 for none; the next row that hangs on the same one, in a circle. */
static const int parent[] = {
    1, 2, -1
};

static const int beside[] = {
    0, 1, 2
};

/* Bars: the rod that each is a part of, how much of its delay; its ends, their ratios, the row of its coupling. */
static const int bar_rod[] = {
    0, 1, 2
};

static const real bar_part[] = {
    1.0, 1.0, 1.0
};

static const int bar_left[] = {
    3, 2, 1
};

static const int bar_right[] = {
    2, 1, 0
};

static const real bar_left_ratio[] = {
    1.0, 1.0, 1.0
};

static const real bar_right_ratio[] = {
    1.0, 1.0, 1.0
};

static const int bar_up[] = {
    4, 1, 0
};

/* Springs between points. */
static const int link_left[] = {
    0
};

static const int link_right[] = {
    0
};

static const real link_ratio[] = {
    0
};

static const int link_up[] = {
    0
};

/* How far places move where nothing is strained; only of a chain that nothing holds. */
static const real rigid[] = {
    0
};

/* Outputs: how often each is differentiated in time; the power of 1/w^2 in its sum of squares; the bar and its end whose
 * slope it reads, or -1; whether the slope counts with the impedance; its factor; whether it is 0 whatever the numbers. */
static const int output_order[] = {
    0, 2, 0, 0, 0, 0
};

static const int output_power[] = {
    2, 0, 2, 1, 1, 1
};

static const int output_bar[] = {
    0, -1, 0, -1, -1, -1
};

static const int output_side[] = {
    1, 0, 0, 0, 0, 0
};

static const int output_force[] = {
    0, 0, 1, 0, 0, 0
};

static const real output_scale[] = {
    1.0, 210000.0, 2100000000.0, 3500.0, 3500.0, 3500.0
};

static const int is_zero[] = {
    0, 0, 0, 0, 0, 0
};

/* Of each GROUP of outputs whether velocities of modes count in them. */
static const int group_moves[] = {
    1
};

/* Otherwise it is a sum over places; where that of each output begins. */
static const int first_term[] = {
    0, 0, 1, 1, 3, 5, 7
};

static const int term_place[] = {
    0, 2, 3, 0, 1, 0, 3
};

static const real term_weight[] = {
    210000.0, 3500.0, -3500.0, 3500.0, -3500.0, 3500.0, -3500.0
};

/* Loads: the place that each acts on, how strongly; amplitudes: the load that each is of, and its roughness. */
static const int load_place[] = {
    3
};

static const real load_gain[] = {
    1.0
};

static const int amplitude_load[] = {
    0
};

/* what 1 of it is in the unit of a stream */
static const real in_step[] = {
    6.481935021769606e-06
};

static const real sample[] = {
    0.0, 6.867401960784314e-07, 1.3734803921568628e-06, 2.0602205882352942e-06, 2.7469607843137255e-06,
    3.4337009803921568e-06, 4.1204411764705885e-06, 4.80718137254902e-06, 5.493921568627451e-06, 6.180661764705882e-06,
    6.8674019607843136e-06, 7.554142156862745e-06, 8.240882352941177e-06, 8.927622549019608e-06, 9.61436274509804e-06,
    1.030110294117647e-05, 1.0987843137254902e-05, 1.1674583333333333e-05, 1.0163754901960784e-05,
    8.652926470588235e-06, 7.142098039215686e-06, 5.631269607843137e-06, 4.120441176470588e-06, 2.6096127450980385e-06,
    1.0987843137254894e-06, -4.120441176470598e-07, -1.922872549019609e-06, -3.433700980392158e-06,
    -4.9445294117647055e-06, -6.455357843137256e-06, -7.966186274509807e-06, -9.477014705882355e-06,
    -1.0987843137254902e-05, -1.2498671568627453e-05, -1.40095e-05, -1.2636019607843138e-05, -1.1262539215686275e-05,
    -9.889058823529411e-06, -8.515578431372548e-06, -7.142098039215687e-06, -5.768617647058823e-06,
    -4.395137254901961e-06, -3.0216568627450983e-06, -1.6481764705882357e-06, -2.746960784313732e-07,
    1.0987843137254894e-06, 2.4722647058823536e-06, 3.845745098039216e-06, 5.219225490196079e-06, 6.592705882352941e-06,
    7.966186274509804e-06, 9.339666666666666e-06, 8.515578431372548e-06, 7.69149019607843e-06, 6.8674019607843136e-06,
    6.0433137254901965e-06, 5.219225490196079e-06, 4.395137254901961e-06, 3.571049019607844e-06, 2.746960784313726e-06,
    1.922872549019608e-06, 1.098784313725491e-06, 2.746960784313732e-07, -5.493921568627447e-07,
    -1.3734803921568625e-06, -2.1975686274509787e-06, -3.0216568627450966e-06, -3.8457450980392144e-06,
    -4.669833333333333e-06, -4.395137254901961e-06, -4.120441176470588e-06, -3.845745098039215e-06,
    -3.571049019607843e-06, -3.2963529411764706e-06, -3.021656862745098e-06, -2.746960784313725e-06,
    -2.4722647058823527e-06, -2.1975686274509804e-06, -1.9228725490196076e-06, -1.6481764705882349e-06,
    -1.3734803921568625e-06, -1.0987843137254902e-06, -8.24088235294117e-07, -5.493921568627447e-07,
    -2.7469607843137234e-07, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
};

/* The numbers of a set without units. False where one is no number, or not positive where it has to be. */
static int values_of(const frame_parameters *p, real *value)
{
    const real *const given[] = {
        p->stiffness,
    };
    const int count[] = {
        FRAME_STIFFNESS_COUNT,
    };
    int number = 0;
    int fine = 1;
    for (int k = 0; k < VALUES; ++k) {
        value[k] = value_of_scene[k];
    }
    for (size_t k = 0; k < sizeof count / sizeof count[0]; ++k) {
        for (int of = 0; of < count[k]; ++of) {
            const real x = given[k][of];
            fine &= x - x == 0 && (parameter_sign[number] == 0 || x > 0 || (parameter_sign[number] == 1 && x >= 0));
            value[parameter_value[number]] = x / parameter_unit[number];
            ++number;
        }
    }
    return fine;
}

/* A chain with its numbers. Arrays over places have one more entry, which is never read. */
typedef struct {
    real delay[BARS + 1];
    real impedance[BARS + 1];
    real mass[PLACES + 1];
    real held[PLACES + 1];
    real across[PLACES + 1];
    real link[LINKS + 1];
} chain;

static void chain_of(const real *value, chain *c)
{
    for (int place = 0; place <= PLACES; ++place) {
        c->mass[place] = place < PLACES ? value[MASS + place] : 0;
        c->held[place] = place < PLACES ? value[SPRING + place] : 0;
        c->across[place] = 0;
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real k = value[ROD_STIFFNESS + bar_rod[bar]];
        const real m = value[ROD_MASS + bar_rod[bar]];
        c->delay[bar] = bar_part[bar] * sqrt(m / k);
        c->impedance[bar] = sqrt(m * k);
    }
    for (int link = 0; link < LINKS; ++link) {
        const real k = value[LINK + link];
        c->link[link] = k;
        c->held[link_left[link]] += link_ratio[link] * link_ratio[link] * k;
        c->held[link_right[link]] += k;
        c->across[link_up[link]] -= link_ratio[link] * k;
    }
}

/* The diagonal of K and what couples each row to its parent, from w^2 and what each bar, were its impedance 1, adds at
 * its ends, and across. */
static void assemble(
    const chain *c, real square, const real *pulled, const real *shared, real *diagonal, real *up)
{
    for (int place = 0; place <= PLACES; ++place) {
        diagonal[place] = c->held[place] - square * c->mass[place];
        up[place] = c->across[place];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real left = bar_left_ratio[bar];
        const real right = bar_right_ratio[bar];
        const real z = c->impedance[bar];
        diagonal[bar_left[bar]] += left * left * z * pulled[bar];
        diagonal[bar_right[bar]] += right * right * z * pulled[bar];
        up[bar_up[bar]] += left * right * z * shared[bar];
    }
}

/* The pivots of K, in place of its diagonal, tips first. */
static void eliminate(real *diagonal, const real *up)
{
    for (int row = 0; row < ROWS; ++row) {
        if (parent[row] >= 0) {
            diagonal[parent[row]] -= up[row] * up[row] / diagonal[row];
        }
    }
}

/* How many frequencies lie below w: those of bars whose ends rest, and negative pivots. */
static int count_below(const chain *c, real w)
{
    real pulled[BARS + 1];
    real shared[BARS + 1];
    real pivot[PLACES + 1];
    real up[PLACES + 1];
    int count = 0;
    for (int bar = 0; bar < BARS; ++bar) {
        const real angle = w * c->delay[bar];
        const real sine = sin(angle);
        const real turn = floor(angle / 3.14159265358979323846 + 0.5);
        const int odd = fmod(turn, 2) != 0;
        /* such that the sine has the sign that goes with it */
        count += (int)turn - ((odd ? -sine : sine) < 0);
        pulled[bar] = w * cos(angle) / sine;
        shared[bar] = -w / sine;
    }
    assemble(c, w * w, pulled, shared, pivot, up);
    eliminate(pivot, up);
    for (int row = 0; row < ROWS; ++row) {
        count += pivot[row] < 0;
    }
    return count;
}

/* Above the n-th frequency, n from 1 on. */
static real above(const chain *c, int n)
{
    real total = 0;
    if (MASSIVE) {
        for (int row = 0; row < ROWS; ++row) {
            total += c->mass[row] > 0 ? c->held[row] / c->mass[row] : 0;
        }
        return total > 0 ? 2 * sqrt(total) : 1;
    }
    for (int bar = 0; bar < BARS; ++bar) {
        total += c->delay[bar];
    }
    return (n + BARS) * 3.14159265358979323846 / total;
}

/* The first FOUND frequencies, by bisection; each count is used for all of them. */
static void find_frequencies(const chain *c, real *w)
{
    real low[FOUND];
    for (int n = 0; n < FOUND; ++n) {
        low[n] = 0;
        w[n] = above(c, n + 1);
    }
    for (int n = 0; n < FOUND; ++n) {
        for (int times = 0; times < 64; ++times) {
            const real middle = (low[n] + w[n]) / 2;
            if (!(middle > low[n] && middle < w[n])) {
                break;
            }
            const int below = count_below(c, middle);
            for (int other = n; other < FOUND; ++other) {
                if (other < below) {
                    w[other] = middle < w[other] ? middle : w[other];
                } else {
                    low[other] = middle > low[other] ? middle : low[other];
                }
            }
        }
    }
    if (FREE) {
        w[0] = 0;
    }
}

/* Of a mode cot and 1/sin of its frequency times each delay. */
typedef struct {
    real angle[BARS + 1];
    real cosine[BARS + 1];
    real cot[BARS + 1];
    real csc[BARS + 1];
} angles;

static void angles_of(const chain *c, real w, angles *a)
{
    for (int bar = 0; bar < BARS; ++bar) {
        a->angle[bar] = w * c->delay[bar];
        a->cosine[bar] = cos(a->angle[bar]);
        a->csc[bar] = 1 / sin(a->angle[bar]);
        a->cot[bar] = a->cosine[bar] * a->csc[bar];
    }
}

/* What is left of the parent of each row once all but the row's own branch is eliminated. */
static void eliminate_beyond(const real *diagonal, const real *pivot, const real *up, real *beyond)
{
    for (int row = ROWS - 1; row >= 0; --row) {
        const int on = parent[row];
        if (on < 0) {
            beyond[row] = pivot[row];
            continue;
        }
        beyond[row] = diagonal[on];
        for (int other = beside[row]; other != row; other = beside[other]) {
            beyond[row] -= up[other] * up[other] / pivot[other];
        }
        if (parent[on] >= 0) {
            beyond[row] -= up[on] * up[on] / beyond[on];
        }
    }
}

/* Absolute values of the terms of q^T K q. */
static real energy(const real *diagonal, const real *up, const real *moved)
{
    real total = 0;
    for (int row = 0; row < ROWS; ++row) {
        total += diagonal[row] * moved[row] * moved[row];
        total += parent[row] < 0 ? 0 : 2 * fabs(up[row] * moved[row] * moved[parent[row]]);
    }
    return total;
}

/* The mass of a shape, that of bars included. */
static real moved_mass(const chain *c, const angles *a, real w, const real *moved)
{
    real total = 0;
    for (int row = 0; row < ROWS; ++row) {
        total += c->mass[row] * moved[row] * moved[row];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real t = c->delay[bar];
        const real s = a->csc[bar];
        const real left = bar_left_ratio[bar] * moved[bar_left[bar]];
        const real right = bar_right_ratio[bar] * moved[bar_right[bar]];
        const real same = (t * s * s - a->cot[bar] / w) / 2;
        const real other = s / w - t * a->cot[bar] * s;
        total += c->impedance[bar] * (same * (left * left + right * right) + other * left * right);
    }
    return total;
}

/* The row on which the least is left once all others are eliminated. */
static int loose_row(const real *pivot, const real *up, const real *beyond)
{
    int root = 0;
    real least = -1;
    for (int row = 0; row < ROWS; ++row) {
        const real left = fabs(parent[row] < 0 ? pivot[row] : pivot[row] - up[row] * up[row] / beyond[row]);
        if (left < least || (least < 0 && left >= 0)) {
            least = left;
            root = row;
        }
    }
    return root;
}

/* The mode of mass 1 with frequency w. K is eliminated from the tips and from the root; in the row on which the least is
 * left a mode needs no force, and from there its shape is what each branch does (Parlett and Dhillon 1997).
 * By rounding w^2 is about as `wrong`, and the shape as `blurred`, relative to its size. */
static void find_shape(const chain *c, const angles *a, real w, real *moved, real *wrong, real *blurred)
{
    real pulled[BARS + 1];
    real shared[BARS + 1];
    real diagonal[PLACES + 1];
    real pivot[PLACES + 1];
    real up[PLACES + 1];
    real beyond[ROWS];
    int towards[ROWS];
    for (int bar = 0; bar < BARS; ++bar) {
        pulled[bar] = w * a->cot[bar];
        shared[bar] = -w * a->csc[bar];
    }
    assemble(c, w * w, pulled, shared, diagonal, up);
    assemble(c, w * w, pulled, shared, pivot, up);
    eliminate(pivot, up);
    eliminate_beyond(diagonal, pivot, up, beyond);
    for (int place = 0; place < PLACES; ++place) {
        moved[place] = 0;
    }
    for (int row = 0; row < ROWS; ++row) {
        towards[row] = 0;
    }
    const int root = loose_row(pivot, up, beyond);
    moved[root] = 1;
    towards[root] = 1;
    for (int row = root; parent[row] >= 0; row = parent[row]) {
        moved[parent[row]] = -up[row] * moved[row] / beyond[row];
        towards[parent[row]] = 1;
    }
    for (int row = ROWS - 1; row >= 0; --row) {
        if (!towards[row] && parent[row] >= 0) {
            moved[row] = -up[row] * moved[parent[row]] / pivot[row];
        }
    }
    const real scale = 1 / sqrt(moved_mass(c, a, w, moved));
    for (int row = 0; row < ROWS; ++row) {
        moved[row] *= scale;
    }
    /* an angle is as wrong as its last digit: near a resonance of a bar that counts */
    for (int bar = 0; bar < BARS; ++bar) {
        const real s = fabs(a->csc[bar]);
        const real cot = fabs(a->cot[bar]);
        pulled[bar] = w * (cot + a->angle[bar] * s * s);
        shared[bar] = w * s * (1 + a->angle[bar] * cot);
    }
    assemble(c, -w * w, pulled, shared, diagonal, up);
    *wrong = 4 * DBL_EPSILON * energy(diagonal, up, moved);
    /* so do terms of the mass of bars, which nearly cancel where points are nearly at rest */
    for (int bar = 0; bar < BARS; ++bar) {
        const real s = fabs(a->csc[bar]);
        pulled[bar] = c->delay[bar] * s * s * (1 + a->angle[bar] * s);
    }
    assemble(c, 0, pulled, pulled, diagonal, up);
    *blurred = 4 * DBL_EPSILON * energy(diagonal, up, moved);
}

/* The strain at the end of a bar, times its speed, in a mode. */
static real slope_of_mode(const chain *c, const angles *a, real w, const real *moved, int bar, int side)
{
    const real left = bar_left_ratio[bar] * moved[bar_left[bar]];
    const real right = bar_right_ratio[bar] * moved[bar_right[bar]];
    (void)c;
    if (!(w > 0)) {
        return 0;
    }
    if (side) {
        return w * (right * a->cosine[bar] - left) * a->csc[bar];
    }
    return w * (right - left * a->cosine[bar]) * a->csc[bar];
}

/* K where nothing moves, eliminated, and the motion without strain, of mass 1. */
typedef struct {
    real pivot[PLACES + 1];
    real up[PLACES + 1];
    real still[PLACES + 1];
} springs;

/* How far the end of a bar moves. */
static real end_of(const real *moved, int bar, int side)
{
    return side ? bar_right_ratio[bar] * moved[bar_right[bar]] : bar_left_ratio[bar] * moved[bar_left[bar]];
}

/* The mass of a shape that is linear along bars; the end of one of them moves by `gap` more. */
static real linear_mass(const chain *c, const real *moved, int broken, int side, real gap)
{
    real total = 0;
    for (int place = 0; place < PLACES; ++place) {
        total += c->mass[place] * moved[place] * moved[place];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real left = end_of(moved, bar, 0) + (bar == broken && !side ? gap : 0);
        const real right = end_of(moved, bar, 1) + (bar == broken && side ? gap : 0);
        total += c->impedance[bar] * c->delay[bar] / 3 * (left * left + left * right + right * right);
    }
    return total;
}

static void springs_of(const chain *c, springs *s)
{
    real pulled[BARS + 1];
    real shared[BARS + 1];
    for (int bar = 0; bar < BARS; ++bar) {
        pulled[bar] = 1 / c->delay[bar];
        shared[bar] = -1 / c->delay[bar];
    }
    assemble(c, 0, pulled, shared, s->pivot, s->up);
    eliminate(s->pivot, s->up);
    for (int place = 0; place < PLACES; ++place) {
        s->still[place] = FREE ? rigid[place] : 0;
    }
    if (FREE) {
        const real scale = 1 / sqrt(linear_mass(c, s->still, -1, 0, 0));
        for (int place = 0; place < PLACES; ++place) {
            s->still[place] *= scale;
        }
    }
}

/* How far places move under forces. Where nothing holds the chain forces balance, and its root does not move. */
static void solve(const springs *s, const real *force, real *moved)
{
    for (int place = 0; place < PLACES; ++place) {
        moved[place] = place < ROWS ? force[place] : 0;
    }
    for (int row = 0; row < ROWS; ++row) {
        if (parent[row] >= 0) {
            moved[parent[row]] -= s->up[row] * moved[row] / s->pivot[row];
        }
    }
    for (int row = ROWS - 1; row >= 0; --row) {
        if (parent[row] >= 0) {
            moved[row] = (moved[row] - s->up[row] * moved[parent[row]]) / s->pivot[row];
        } else {
            moved[row] = FREE ? 0 : moved[row] / s->pivot[row];
        }
    }
}

/* The forces that accelerate everything as places move. */
static void inertia(const chain *c, const real *moved, real *force)
{
    for (int place = 0; place < PLACES; ++place) {
        force[place] = c->mass[place] * moved[place];
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real share = c->impedance[bar] * c->delay[bar] / 6;
        const real left = end_of(moved, bar, 0);
        const real right = end_of(moved, bar, 1);
        force[bar_left[bar]] += share * bar_left_ratio[bar] * (2 * left + right);
        force[bar_right[bar]] += share * bar_right_ratio[bar] * (left + 2 * right);
    }
}

static real along(const springs *s, const real *force)
{
    real total = 0;
    for (int place = 0; place < PLACES; ++place) {
        total += force[place] * s->still[place];
    }
    return total;
}

/* The shape under forces; bars are `bent` by accelerations where nothing holds the chain. */
static void loaded_shape(const chain *c, const springs *s, const real *force, real *moved, real *bent)
{
    real acting[PLACES];
    real pull[PLACES];
    const real part = FREE ? along(s, force) : 0;
    for (int place = 0; place < PLACES; ++place) {
        bent[place] = part * s->still[place];
        acting[place] = force[place];
    }
    if (!FREE) {
        solve(s, acting, moved);
        return;
    }
    inertia(c, bent, pull);
    for (int place = 0; place < PLACES; ++place) {
        acting[place] -= pull[place];
    }
    solve(s, acting, moved);
    inertia(c, moved, pull);
    real left = along(s, pull);
    for (int bar = 0; bar < BARS; ++bar) {
        const real t = c->delay[bar];
        left -= end_of(s->still, bar, 0) * end_of(bent, bar, 0) * c->impedance[bar] * t * t * t / 12;
    }
    for (int place = 0; place < PLACES; ++place) {
        moved[place] -= left * s->still[place];
    }
}

/* The shape that the unit motion of a place imposes. */
static void imposed_shape(const chain *c, const springs *s, int place, real *moved)
{
    real force[PLACES];
    for (int other = 0; other < PLACES; ++other) {
        force[other] = 0;
    }
    for (int bar = 0; bar < BARS; ++bar) {
        const real k = c->impedance[bar] / c->delay[bar] * bar_left_ratio[bar] * bar_right_ratio[bar];
        if (bar_left[bar] == place) {
            force[bar_right[bar]] += k;
        }
        if (bar_right[bar] == place) {
            force[bar_left[bar]] += k;
        }
    }
    for (int link = 0; link < LINKS; ++link) {
        const real k = c->link[link] * link_ratio[link];
        if (link_left[link] == place) {
            force[link_right[link]] += k;
        }
        if (link_right[link] == place) {
            force[link_left[link]] += k;
        }
    }
    solve(s, force, moved);
    moved[place] = 1;
}

/* The strain at the end of a bar, times its speed, in a shape under loads. */
static real slope_of_shape(const chain *c, const real *moved, const real *bent, int bar, int side)
{
    const real t = c->delay[bar];
    const real pull = t * (2 * end_of(bent, bar, side) + end_of(bent, bar, !side)) / 6;
    return (end_of(moved, bar, 1) - end_of(moved, bar, 0)) / t + (side ? pull : -pull);
}

/* The sum of the squares of the slope at the end of a bar over w^4, of all modes. */
static real break_mass(const chain *c, const springs *s, int bar, int side)
{
    real force[PLACES];
    real moved[PLACES];
    const real gap = (side ? -1 : 1) / c->impedance[bar];
    for (int place = 0; place < PLACES; ++place) {
        force[place] = 0;
    }
    force[bar_left[bar]] -= bar_left_ratio[bar] / c->delay[bar];
    force[bar_right[bar]] += bar_right_ratio[bar] / c->delay[bar];
    solve(s, force, moved);
    const real mass = linear_mass(c, moved, bar, side, gap);
    if (!FREE) {
        return mass;
    }
    inertia(c, moved, force);
    const real part =
        along(s, force) + end_of(s->still, bar, side) * gap * c->impedance[bar] * c->delay[bar] / 2;
    return mass - part * part;
}

/* By mode: frequencies, how wrong w^2 and how blurred shapes are, what outputs are of modes, and their shares in loads.
 * What outputs are of the shape that a load imposes, and under one that does not change; sums of squares over all modes,
 * of loads over w^2 where they are forces. */
typedef struct {
    real w[FOUND];
    real wrong[FOUND];
    real blurred[FOUND];
    real output[OUTPUTS][FOUND];
    real share[LOADS][FOUND];
    real imposed[OUTPUTS][LOADS];
    real settled[OUTPUTS][LOADS];
    real output_total[OUTPUTS];
    real load_total[LOADS];
} projection;

/* A sum and what its additions have lost. */
typedef struct {
    real sum;
    real lost;
} long_sum;

static void add(long_sum *total, real x)
{
    const volatile real sum = total->sum + x;
    const volatile real part = sum - total->sum;
    const volatile real rest = sum - part;
    total->lost += (total->sum - rest) + (x - part);
    total->sum = sum;
}

/* What an output is of a shape: of how far places move, or of the slope at the end of its bar. */
static real output_value(const chain *c, int output, const real *moved, real slope)
{
    const int bar = output_bar[output];
    real total = 0;
    if (bar >= 0) {
        return output_scale[output] * (output_force[output] ? c->impedance[bar] : c->delay[bar]) * slope;
    }
    for (int term = first_term[output]; term < first_term[output + 1]; ++term) {
        total += term_weight[term] * moved[term_place[term]];
    }
    return total;
}

static real value_of_mode(const chain *c, const angles *a, real w, int output, const real *moved)
{
    const int bar = output_bar[output];
    const real slope = bar < 0 ? 0 : slope_of_mode(c, a, w, moved, bar, output_side[output]);
    return output_value(c, output, moved, slope);
}

static real value_of_shape(const chain *c, int output, const real *moved, const real *bent)
{
    const int bar = output_bar[output];
    const real slope = bar < 0 ? 0 : slope_of_shape(c, moved, bent, bar, output_side[output]);
    return output_value(c, output, moved, slope);
}

/* The share of a mode in a load. */
static real share_of(const chain *c, const angles *a, real w, int load, const real *moved)
{
    const int place = load_place[load];
    real pull = 0;
    if (place < ROWS) {
        return moved[place] * load_gain[load];
    }
    /* what holds the end in the mode, over w^2, is the mass that both move together: the mode and what the end imposes */
    for (int bar = 0; bar < BARS; ++bar) {
        if (bar_left[bar] == place) {
            pull += slope_of_mode(c, a, w, moved, bar, 0) * c->impedance[bar] * bar_left_ratio[bar];
        }
        if (bar_right[bar] == place) {
            pull -= slope_of_mode(c, a, w, moved, bar, 1) * c->impedance[bar] * bar_right_ratio[bar];
        }
    }
    for (int link = 0; link < LINKS; ++link) {
        const real k = link_ratio[link] * c->link[link];
        pull += link_left[link] == place ? moved[link_right[link]] * k : 0;
        pull += link_right[link] == place ? moved[link_left[link]] * k : 0;
    }
    return -pull * load_gain[load] / (w * w);
}

static void project_modes(const chain *c, const springs *s, projection *p)
{
    find_frequencies(c, p->w);
    for (int n = 0; n < FOUND; ++n) {
        const real w = p->w[n];
        real moved[PLACES];
        angles a;
        angles_of(c, w, &a);
        if (FREE && n == 0) {
            p->wrong[n] = 0;
            p->blurred[n] = 0;
            for (int place = 0; place < PLACES; ++place) {
                moved[place] = s->still[place];
            }
        } else {
            find_shape(c, &a, w, moved, &p->wrong[n], &p->blurred[n]);
        }
        for (int output = 0; output < OUTPUTS; ++output) {
            p->output[output][n] = value_of_mode(c, &a, w, output, moved);
        }
        for (int load = 0; load < LOADS; ++load) {
            p->share[load][n] = share_of(c, &a, w, load, moved);
        }
    }
}

/* What an output is of the shape that a load imposes: 0 where it is that but for rounding, as of a drift. */
static real imposed_value(const chain *c, int output, const real *imposed, const real *still)
{
    const real value = value_of_shape(c, output, imposed, still);
    real size = 0;
    if (output_bar[output] >= 0) {
        size = fabs(output_value(c, output, imposed, 1 / c->delay[output_bar[output]]));
    }
    for (int term = first_term[output]; term < first_term[output + 1]; ++term) {
        size += fabs(term_weight[term]);
    }
    return fabs(value) > 1e-12 * size ? value : 0;
}

static void project_loads(const chain *c, const springs *s, projection *p)
{
    for (int load = 0; load < LOADS; ++load) {
        const int place = load_place[load];
        const real gain = load_gain[load];
        real none[PLACES];
        real force[PLACES];
        real imposed[PLACES];
        real moved[PLACES];
        real bent[PLACES];
        for (int other = 0; other < PLACES; ++other) {
            none[other] = 0;
            force[other] = other == place;
        }
        if (place < ROWS) {
            loaded_shape(c, s, force, moved, bent);
            p->load_total[load] = moved[place] * gain * gain;
        } else {
            imposed_shape(c, s, place, imposed);
            inertia(c, imposed, force);
            for (int other = 0; other < PLACES; ++other) {
                force[other] = -force[other];
                bent[other] = imposed[other];
            }
            solve(s, force, moved);
            p->load_total[load] = linear_mass(c, imposed, -1, 0, 0) * gain * gain;
        }
        for (int output = 0; output < OUTPUTS; ++output) {
            p->settled[output][load] = value_of_shape(c, output, moved, bent) * gain;
            p->imposed[output][load] = place < ROWS ? 0 : imposed_value(c, output, imposed, none) * gain;
        }
    }
}

/* The sums over all modes of the squares of outputs, over w^(2 power). */
static void project_outputs(const chain *c, const springs *s, projection *p)
{
    for (int output = 0; output < OUTPUTS; ++output) {
        const int bar = output_bar[output];
        real force[PLACES];
        real moved[PLACES];
        real bent[PLACES];
        real total = 0;
        real part = 0;
        for (int place = 0; place < PLACES; ++place) {
            force[place] = 0;
        }
        for (int term = first_term[output]; term < first_term[output + 1]; ++term) {
            const int place = term_place[term];
            force[place] += term_weight[term];
            part += term_weight[term] * s->still[place];
            total += c->mass[place] > 0 ? term_weight[term] * term_weight[term] / c->mass[place] : 0;
        }
        if (bar >= 0) {
            const real weight = output_value(c, output, force, 1);
            total = break_mass(c, s, bar, output_side[output]) * weight * weight;
        } else if (output_power[output] == 0) {
            total -= part * part;
        } else {
            loaded_shape(c, s, force, moved, bent);
            total = value_of_shape(c, output, moved, bent);
        }
        p->output_total[output] = total;
    }
}

/* What is left of a sum over all modes without those that are found, and what its roundings may be. */
static real left_over(const projection *p, const real *row, int power, real total)
{
    const real spare = (1 + 1e-12) * total;
    long_sum left = {spare, 0};
    for (int n = 0; n < FOUND; ++n) {
        const real w = p->w[n];
        if (w > 0) {
            add(&left, -row[n] * row[n] / (power == 2 ? w * w * w * w : power == 1 ? w * w : 1));
        }
    }
    left.sum += left.lost;
    return (left.sum > 0 ? left.sum : 0) + 8 * DBL_EPSILON * spare;
}

/* What the modes that are not found do to an output under a load that does not change. */
static real rest_of(const projection *p, int output, int load)
{
    long_sum rest = {p->settled[output][load], 0};
    for (int n = 0; n < FOUND; ++n) {
        if (p->w[n] > 0) {
            add(&rest, -p->output[output][n] * (p->share[load][n] / p->w[n] / p->w[n]));
        }
    }
    return rest.sum + rest.lost;
}

/* Of displacement and velocity the entries of the matrix, and what a constant force and a growing one cause. */
typedef struct {
    real p12;
    real p22;
    real one;
    real two;
} turn;

/* A power series, where nothing much happens in s. */
static turn turn_little(real s, real w, real decay)
{
    turn made = {0, 0, 0, 0};
    real before = 0;
    real term = 1;
    for (int k = 1; k < 28; ++k) {
        const real next = -(2 * decay * s * term + w * s * w * s / k * before) / (k + 1);
        made.p22 += k * term;
        made.p12 += term;
        made.one += term / (k + 1);
        made.two += term / ((k + 1) * (k + 2));
        before = term;
        term = next;
    }
    made.p12 *= s;
    made.one *= s * s;
    made.two *= s * s * s;
    return made;
}

/* The mean of exp from -u to 0. */
static real mean_of_exp(real u)
{
    return u > 0 ? -expm1(-u) / u : 1;
}

/* Damping of 1 or more: two rates, the slow one without cancellation. */
static turn turn_creeping(real s, real w, real damping)
{
    const real apart = w * sqrt((damping - 1) * (damping + 1));
    const real decay = damping * w;
    const real fast = decay + apart;
    const real z = w * w / fast * s;
    const real x = 2 * apart * s;
    const real shrunk = exp(-z);
    real series = 1;
    turn made;
    for (int k = 20; k > 2; --k) {
        series = 1 - (z < 1 ? z : 1) / k * series;
    }
    made.p12 = s * shrunk * mean_of_exp(x);
    made.p22 = shrunk * (1 + exp(-x)) / 2 - decay * made.p12;
    made.one = s * (mean_of_exp(z) - shrunk * mean_of_exp(x)) / fast;
    made.two = (s * s * (z < 1 ? series / 2 : (1 - mean_of_exp(z)) / z) - made.one) / fast;
    return made;
}

static turn turn_swinging(real s, real w, real damping)
{
    const real decay = damping * w;
    const real turning = w * sqrt((1 - damping) * (1 + damping));
    const real shrunk = exp(-decay * s);
    const real cosine = shrunk * cos(turning * s);
    turn made;
    made.p12 = shrunk * (sin(turning * s) / turning);
    made.p22 = cosine - decay * made.p12;
    made.one = (1 - (cosine + decay * made.p12)) / (w * w);
    made.two = (s - 2 * decay * made.one - made.p12) / (w * w);
    return made;
}

/* What all oscillators do in s. */
static void turns_of(const real *frequency, const real *damping, real s, turns *t)
{
    for (int n = 0; n < MODES; ++n) {
        const real w = frequency[n];
        const real z = damping[n];
        const int little = (w + 2 * z * w) * s <= 2;
        const turn made = little ? turn_little(s, w, z * w) : z < 1 ? turn_swinging(s, w, z) : turn_creeping(s, w, z);
        t->p11[n] = made.p22 + 2 * z * w * made.p12;
        t->p12[n] = made.p12;
        t->p21[n] = -w * w * made.p12;
        t->p22[n] = made.p22;
        t->one[n] = made.one;
        t->two[n] = made.two;
    }
}

/* The ratios of the first modes with strain, the last one for all higher ones; or a/w + b w, halved, for all. */
typedef struct {
    real ratio[RATIOS];
    real a;
    real b;
} damping_rule;

/* What the modes left out, which have frequencies of at least w, do under a load: a mode with shares l and b adds at most
 * size |l b|/w^power to displacements, velocities and accelerations. */
typedef struct {
    real size[3];
    int power[3];
} declines;

static damping_rule damping_of(const real *value, const projection *p)
{
    damping_rule rule = {{0}, 0, 0};
    for (int k = 0; k < RATIOS; ++k) {
        rule.ratio[k] = value[RATIO + k];
    }
    if (FIRST_MODE > 0) {
        const real first = p->w[FIRST_MODE - 1 + FREE];
        const real second = p->w[SECOND_MODE - 1 + FREE];
        rule.a = 2 * rule.ratio[0] * first * second / (first + second);
        rule.b = 2 * rule.ratio[0] / (first + second);
    }
    return rule;
}

/* The ratio at a frequency, that of the n-th mode with strain. */
static real ratio_at(const damping_rule *rule, real w, int n)
{
    if (!(w > 0)) {
        return 0;
    }
    return rule->b > 0 ? (rule->a / w + rule->b * w) / 2 : rule->ratio[n < RATIOS ? n : RATIOS - 1];
}

/* The largest, or least, ratio of the modes left out. */
static real extreme_ratio(const damping_rule *rule, real w, int least)
{
    const int count = FOUND - FREE;
    if (rule->b > 0) {
        if (!least) {
            return HUGE_VAL;
        }
        return rule->b * w * w < rule->a ? sqrt(rule->a * rule->b) : (rule->a / w + rule->b * w) / 2;
    }
    real found = rule->ratio[RATIOS - 1];
    for (int k = count < RATIOS - 1 ? count : RATIOS - 1; k < RATIOS; ++k) {
        found = (rule->ratio[k] < found) == least && rule->ratio[k] != found ? rule->ratio[k] : found;
    }
    return found;
}

/* The sample of a load. */
static real load_at(const model *m, int load, int k)
{
    real total = 0;
    for (int amplitude = 0; amplitude < AMPLITUDES; ++amplitude) {
        if (amplitude_load[amplitude] == load && k < SAMPLES) {
            total += m->factor[amplitude] * sample[amplitude * SAMPLES + k];
        }
    }
    return total;
}

static real least_of(real x, real y)
{
    return x < y ? x : y;
}

static real most_of(real x, real y)
{
    return x > y ? x : y;
}

static declines declines_under(const model *m, const damping_rule *rule, real w, int load)
{
    const real least = extreme_ratio(rule, w, 1);
    const real most = extreme_ratio(rule, w, 0);
    const real fade = exp(-least * w * spacing);
    real steep = 0;
    real fading = 0;
    real kinked = 0;
    real sum = 0;
    real slope = 0;
    real together = 0;
    for (int k = 0; k < SAMPLES && k * spacing <= tau_max; ++k) {
        const real next = (load_at(m, load, k + 1) - load_at(m, load, k)) / spacing;
        const real kink = fabs(next - slope) + 2 * DBL_EPSILON * (fabs(next) + fabs(slope));
        sum = sum * fade + kink;
        fading = most_of(fading, sum);
        kinked = most_of(kinked, kink);
        steep = most_of(steep, fabs(next));
        slope = next;
    }
    for (int amplitude = 0; amplitude < AMPLITUDES; ++amplitude) {
        together += amplitude_load[amplitude] == load ? fabs(m->factor[amplitude]) * in_step[amplitude] : 0;
    }
    declines made = {{0, 0, 0}, {3, 2, 1}};
    if (rule->b > 0) {
        const real late = steep * (2 / rule->b + rule->a);
        const real small = least_of(1, least);
        made.size[0] = late / (small * small);
        made.size[1] = 4 * late / rule->b;
        made.size[2] = 4 * steep / rule->b;
        made.power[0] = 4;
        made.power[1] = 4;
        made.power[2] = 2;
        return made;
    }
    const real faded = fading > 2 * kinked ? least_of(fading, 2 * together) : fading;
    const real swing = most < 1 ? (most > 0 ? faded : together) / sqrt(1 - most * most) : HUGE_VAL;
    const real crept = least > 0 ? steep / least : HUGE_VAL;
    made.size[0] = least_of(swing + 2 * most * steep, most_of(2 * crept, 2 * most * steep));
    made.size[1] = steep + swing;
    if (least > 0) {
        made.size[1] = least_of(steep + swing, least < 1 ? crept : steep);
    }
    made.size[2] = least_of(swing, 2 * crept);
    return made;
}

/* About how wrong an output is, relative to its largest value, as modes are: a frequency that is a little wrong is so for
 * as long as its mode remembers, and a shape has some of its neighbours'. */
static real looseness(const model *m, const projection *p, int output)
{
    real largest = 0;
    real total = 0;
    for (int n = 0; n < FOUND; ++n) {
        const real w = p->w[n];
        const real square = w * w;
        real share = 0;
        real gap = HUGE_VAL;
        if (!(w > 0)) {
            continue;
        }
        if (n > 0) {
            gap = square - p->w[n - 1] * p->w[n - 1];
        }
        if (n + 1 < FOUND) {
            gap = least_of(gap, p->w[n + 1] * p->w[n + 1] - square);
        }
        for (int load = 0; load < LOADS; ++load) {
            share = most_of(share, fabs(p->share[load][n]));
        }
        const int order = output_order[output];
        const real size = share * fabs(p->output[output][n]) / (order == 2 ? 1 : order == 1 ? w : square);
        const real decay = m->damping[n] * w;
        const real kept = decay * tau_max > 1 ? 1 / decay : tau_max;
        largest = most_of(largest, size);
        if (size > 0) {
            total += size * (p->wrong[n] / (2 * w) * kept + p->wrong[n] / gap + p->blurred[n]);
        }
    }
    return largest > 0 ? total / largest : 0;
}

/* About the largest error of an output whose largest value is this. */
static real error_of(
    const model *m, const projection *p, const damping_rule *rule, const declines *fall, int output, real largest)
{
    const real w = p->w[FOUND - 1] * (1 - DBL_EPSILON);
    const int order = output_order[output];
    const real left = left_over(p, p->output[output], output_power[output], p->output_total[output]);
    real error = 0;
    if (is_zero[output]) {
        return 0;
    }
    for (int load = 0; load < LOADS; ++load) {
        const int power = load_place[load] < ROWS;
        const real other = left_over(p, p->share[load], power, p->load_total[load]);
        const real size = fall[load].size[order];
        const real root = sqrt(left * other);
        /* nothing left out adds nothing */
        error += root > 0 ? root * size * pow(w, output_power[output] + power - fall[load].power[order]) : 0;
        if (rule->b > 0 && order < 2) {
            error += fabs(rest_of(p, output, load)) * size / (64 * w * w);
        }
    }
    error *= 1 + 1e-12;
    return error + (32 * DBL_EPSILON * sqrt((real)SAMPLES) + looseness(m, p, output)) * largest;
}

static void rest(motion *s)
{
    for (int n = 0; n < MODES; ++n) {
        s->y[n] = 0;
        s->v[n] = 0;
    }
    for (int j = 0; j < LOADS; ++j) {
        s->load[j] = 0;
        s->once[j] = 0;
        s->twice[j] = 0;
    }
}

/* How they move `time` later, for which `t` are the turns, while loads go by `slope`. */
static void advance(const model *m, const turns *t, real time, const real *slope, const motion *s, motion *out)
{
    real start[MODES];
    real ramp[MODES];
    for (int n = 0; n < MODES; ++n) {
        start[n] = 0;
        ramp[n] = 0;
    }
    for (int j = 0; j < LOADS; ++j) {
        for (int n = 0; n < MODES; ++n) {
            start[n] += m->push[j][n] * s->load[j];
            ramp[n] += m->push[j][n] * slope[j];
        }
    }
    for (int n = 0; n < MODES; ++n) {
        const real y = s->y[n];
        const real v = s->v[n];
        out->y[n] = t->p11[n] * y + t->p12[n] * v + t->one[n] * start[n] + t->two[n] * ramp[n];
        out->v[n] = t->p21[n] * y + t->p22[n] * v + t->p12[n] * start[n] + t->one[n] * ramp[n];
    }
    for (int j = 0; j < LOADS; ++j) {
        const real load = s->load[j];
        const real once = s->once[j];
        out->twice[j] = s->twice[j] + time * (once + time / 2 * (load + time / 3 * slope[j]));
        out->once[j] = once + time * (load + time / 2 * slope[j]);
        out->load[j] = load + time * slope[j];
    }
}

/* All outputs of TOGETHER motions, and zeros up to FILLED: sums side by side, as one waits for each of its additions. */
static void read_together(const model *m, const motion *const *s, real *const *out)
{
    for (int first = 0; first < FILLED; first += LANES) {
        slice sum[TOGETHER];
        for (int k = 0; k < TOGETHER; ++k) {
            sum[k] = *(const slice *)(m->direct[0][0] + first) * s[k]->load[0];
            for (int j = 1; j < LOADS; ++j) {
                sum[k] += *(const slice *)(m->direct[j][0] + first) * s[k]->load[j];
            }
            for (int j = 0; SUMS && j < LOADS; ++j) {
                sum[k] += *(const slice *)(m->direct[j][1] + first) * s[k]->once[j];
                sum[k] += *(const slice *)(m->direct[j][2] + first) * s[k]->twice[j];
            }
        }
        for (int n = 0; n < MODES; ++n) {
            const slice weight = *(const slice *)(m->moved[n] + first);
            UNROLLED
            for (int k = 0; k < TOGETHER; ++k) {
                sum[k] += weight * s[k]->y[n];
            }
        }
        for (int n = 0; group_moves[first / GROUP] && n < MODES; ++n) {
            const slice weight = *(const slice *)(m->moving[n] + first);
            UNROLLED
            for (int k = 0; k < TOGETHER; ++k) {
                sum[k] += weight * s[k]->v[n];
            }
        }
        for (int k = 0; k < TOGETHER; ++k) {
            *(slice *)(out[k] + first) = sum[k];
        }
    }
}

static void read_motion(const model *m, const motion *s, real *out)
{
    const motion *all[TOGETHER];
    real *values[TOGETHER];
    for (int k = 0; k < TOGETHER; ++k) {
        all[k] = s;
        values[k] = out;
    }
    read_together(m, all, values);
}

/* The slopes of the scene's loads after their sample k. */
static void slopes_after(const model *m, int k, real *slope)
{
    for (int j = 0; j < LOADS; ++j) {
        slope[j] = (load_at(m, j, k + 1) - load_at(m, j, k)) / spacing;
    }
}

static void weights_of(model *m, const projection *p, const damping_rule *rule)
{
    const real above_all = 8 * p->w[FOUND - 1];
    for (int n = 0; n < MODES; ++n) {
        const real w = n < FOUND ? p->w[n] : above_all;
        m->frequency[n] = w;
        m->damping[n] = ratio_at(rule, w, n - FREE);
        for (int load = 0; load < LOADS; ++load) {
            m->push[load][n] = n < FOUND ? p->share[load][n] : n - FOUND == load ? above_all * above_all : 0;
        }
    }
    for (int output = 0; output < FILLED; ++output) {
        const int counts = output < OUTPUTS && !is_zero[output];
        const int order = counts ? output_order[output] : 0;
        for (int load = 0; load < LOADS; ++load) {
            const real rest = counts && order < 2 ? rest_of(p, output, load) : 0;
            for (int k = 0; k < 3; ++k) {
                m->direct[load][k][output] = counts && k == 2 - order ? p->imposed[output][load] : 0;
            }
            for (int n = 0; order == 2 && n < FOUND; ++n) {
                m->direct[load][0][output] += p->output[output][n] * p->share[load][n];
            }
            if (MODES == FOUND && counts && order == 0) {
                m->direct[load][0][output] += rest;
            }
            if (MODES > FOUND) {
                m->moved[FOUND + load][output] = order == 0 ? rest : 0;
                m->moving[FOUND + load][output] = order == 1 ? rest : 0;
            }
        }
        for (int n = 0; n < FOUND; ++n) {
            const real w = p->w[n];
            const real value = counts ? p->output[output][n] : 0;
            m->moved[n][output] = order == 0 ? value : order == 2 ? -w * w * value : 0;
            m->moving[n][output] = order == 1 ? value : order == 2 ? -2 * m->damping[n] * w * value : 0;
        }
    }
}

/* The largest values at the ends and in the middle of steps. */
static void largest_values(const model *m, real *largest)
{
    motion s[TOGETHER + 1];
    real out[TOGETHER][FILLED];
    const motion *seen[TOGETHER];
    real *values[TOGETHER];
    real slope[LOADS];
    rest(&s[TOGETHER]);
    for (int output = 0; output < OUTPUTS; ++output) {
        largest[output] = 0;
    }
    for (int half = 0; half < HALVES; half += TOGETHER) {
        for (int k = 0; k < TOGETHER; ++k) {
            slopes_after(m, (half + k) / 2, slope);
            advance(m, &m->half, spacing / 2, slope, k > 0 ? &s[k - 1] : &s[TOGETHER], &s[k]);
            seen[k] = &s[k];
            values[k] = out[k];
        }
        s[TOGETHER] = s[TOGETHER - 1];
        read_together(m, seen, values);
        for (int k = 0; k < TOGETHER && half + k < HALVES; ++k) {
            for (int output = 0; output < OUTPUTS; ++output) {
                const real size = fabs(out[k][output]);
                largest[output] = size > largest[output] || size != size ? size : largest[output];
            }
        }
    }
}

/* The worst error relative to its output's largest value. */
static real estimate_of(const model *m, const projection *p, const damping_rule *rule, const real *largest)
{
    declines fall[LOADS];
    real worst = 0;
    for (int load = 0; load < LOADS; ++load) {
        fall[load] = declines_under(m, rule, p->w[FOUND - 1], load);
    }
    for (int output = 0; output < OUTPUTS; ++output) {
        const real error = error_of(m, p, rule, fall, output, largest[output]);
        const real relative = error == 0 ? 0 : error < largest[output] ? error / (largest[output] - error) : HUGE_VAL;
        worst = most_of(worst, relative);
    }
    return worst;
}

/* Find modes and what they make of loads and outputs. False for a bad number. */
static int find_model(model *m, const frame_parameters *parameters, projection *p, damping_rule *rule)
{
    real value[VALUES];
    chain c;
    springs s;
    m->status = 1;
    m->estimate = not_a_number();
    if (!values_of(parameters, value)) {
        return 0;
    }
    for (int amplitude = 0; amplitude < AMPLITUDES; ++amplitude) {
        m->factor[amplitude] = value[FACTOR + amplitude];
    }
    chain_of(value, &c);
    springs_of(&c, &s);
    project_modes(&c, &s, p);
    project_loads(&c, &s, p);
    project_outputs(&c, &s, p);
    *rule = damping_of(value, p);
    weights_of(m, p, rule);
    turns_of(m->frequency, m->damping, spacing / 2, &m->half);
    return 1;
}

/* Say how wrong a model is whose outputs have these largest values. */
static int judge(model *m, const projection *p, const damping_rule *rule, const real *largest)
{
    m->estimate = estimate_of(m, p, rule, largest);
    m->status = m->estimate <= tolerance ? 0 : 2;
    return m->status;
}

/* 0; 1 for a bad number; 2 where modes are too few for the tolerance, or not known well enough. */
static int build(model *m, const frame_parameters *parameters)
{
    projection p;
    damping_rule rule;
    real largest[OUTPUTS];
    if (!find_model(m, parameters, &p, &rule)) {
        return 1;
    }
    largest_values(m, largest);
    return judge(m, &p, &rule, largest);
}

int frame_build(model *m, const frame_parameters *parameters)
{
    return build(m, parameters);
}

real frame_error_estimate(const model *m)
{
    return m->estimate;
}

/* Where the histories of a model have got to: after `half` steps of SPACING/2, and the turns of the time since. */
typedef struct {
    motion s;
    turns t;
    real slope[LOADS];
    real since;
    int half;
} reader;

static void begin_reading(const model *m, reader *r)
{
    rest(&r->s);
    slopes_after(m, 0, r->slope);
    r->since = -1;
    r->half = 0;
}

/* All outputs at a tau not before the last one. */
static void read_at(const model *m, reader *r, real tau, real *values)
{
    motion then;
    while ((r->half + 1) * (spacing / 2) <= tau) {
        advance(m, &m->half, spacing / 2, r->slope, &r->s, &r->s);
        r->half += 1;
        slopes_after(m, r->half / 2, r->slope);
    }
    const real since = tau - r->half * (spacing / 2);
    if (since != r->since) {
        turns_of(m->frequency, m->damping, since, &r->t);
        r->since = since;
    }
    advance(m, &r->t, since, r->slope, &r->s, &then);
    read_motion(m, &then, values);
}

int frame_model_sample(const model *m, real tau0, real dtau, size_t count, real *out)
{
    reader r;
    int wrong = 0;
    begin_reading(m, &r);
    for (size_t place = 0; place < count; ++place) {
        const size_t k = dtau < 0 ? count - 1 - place : place;
        const volatile real product = (real)k * dtau;
        const real tau = tau0 + product;
        const int inside = m->status != 1 && tau >= 0 && tau <= tau_max;
        real values[FILLED];
        wrong |= !inside;
        if (inside) {
            read_at(m, &r, tau, values);
        }
        for (size_t output = 0; output < OUTPUTS; ++output) {
            out[output * count + k] = inside ? values[output] : not_a_number();
        }
    }
    return wrong;
}

int frame_model_eval(const model *m, real tau, real *out)
{
    return frame_model_sample(m, tau, 0, 1, out);
}
