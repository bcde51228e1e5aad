/* wide.h: how many sets of parameters stand side by side.
 * Generated files have what stands below the first empty line, with their scene's name. */

/* As many however this is compiled, so that what is yours has one size; vectors are as wide as your machine's. */
#if !defined(__FRAMAC__)
enum { NAME_WIDTH = 64 / sizeof(name_real) };
#else
enum { NAME_WIDTH = 1 };
#endif
