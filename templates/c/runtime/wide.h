/* wide.h: how many sets of parameters stand side by side, and what the series of waves are as long as. */

/* How many numbers a series of a wave has: zeros up to a whole vector follow. */
enum { NAME_ROW = NAME_DEGREE + 64 / sizeof(name_real) };

/* How many numbers the series of all strands on all windows have, at most, and a whole vector. */
enum { NAME_SERIES = NAME_WINDOWS * NAME_STRANDS * (NAME_DEGREE + 2) + 64 / sizeof(name_real) };

/* How many sets stand side by side: as many however this is compiled, so that what is yours has one size; vectors are as
 * wide as your machine's. */
#if !defined(__FRAMAC__)
enum { NAME_WIDTH = 64 / sizeof(name_real) };
#else
enum { NAME_WIDTH = 1 };
#endif
