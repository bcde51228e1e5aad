/* runtime_batch.h: many sets of parameters side by side, and data to compare them with.
 * Generated files have what stands below the first empty line, with their scene's name. */

/* name_wide is a number of each of NAME_WIDTH sets. With GNU C these are computed at once; NAME_PLAIN asks for plain C. */
#if defined(__GNUC__) && !defined(__FRAMAC__) && !defined(NAME_PLAIN)
#define NAME_VECTORS
#endif
#if defined(NAME_VECTORS)
enum { NAME_WIDTH = 64 / sizeof(name_real) };
typedef name_real name_full __attribute__((vector_size(64)));
typedef name_full name_wide __attribute__((aligned(sizeof(name_real))));
#else
enum { NAME_WIDTH = 1 };
typedef name_real name_wide;
#endif

/* Models of up to NAME_WIDTH sets. Plain data, yours; only `build_batch` writes into it. It is read and written sooner
 * where it begins at a multiple of 64 bytes. */
typedef struct {
    name_wide estimate;
    name_wide series[NAME_WINDOWS * NAME_STRANDS * (NAME_DEGREE + 2)];
    /* for `build_batch` alone, as in a model */
    name_wide waves[2][3][NAME_PANELS][NAME_NODES + 2][NAME_DEGREE + 1];
    name_wide velocity[2][NAME_NODES];
    name_wide table[NAME_PANELS * NAME_NODES][3][NAME_DEGREE + 2];
    name_wide edge[NAME_PANELS * NAME_NODES][3];
    name_wide alpha[NAME_NODES], beta[NAME_NODES], rate[NAME_NODES], gain[NAME_HEARD + 1];
    name_wide total[NAME_HEARD + 1];
    name_wide change[NAME_EVENTS + 1];
    name_wide load[NAME_FORCES + 1][3];
    name_wide force[NAME_PANELS][NAME_FORCES + 1][3];
    name_wide largest[NAME_OUTPUTS];
    name_wide work[NAME_DEGREE + 2];
    name_real inverse[NAME_DEGREE + 2];
    int since[NAME_FORCES + 1][2];
    /* of each set, as `build` returns it; of each window the degree, for all sets, and where its series begin */
    int status[NAME_WIDTH];
    int degree[NAME_WINDOWS];
    size_t place[NAME_WINDOWS];
} name_batch;

/* Data, so that the sum of squares of all misfits is taken from coefficients: with the series c of an output on a section
 * of a window, V c its values and y the data, |V c - y|^2 = |R c - z|^2 + rest. R is a triangle with weights. */
typedef struct {
    size_t place[NAME_WINDOWS * NAME_GROUPS]; /* where in `numbers` those of a group begin */
    int rows[NAME_WINDOWS * NAME_GROUPS];
    name_real *numbers; /* the caller's */
} name_data;
