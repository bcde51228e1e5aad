/* wide.h: numbers of many sets of parameters side by side.
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
