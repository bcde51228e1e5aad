/* tables.h: stands for what plain.c.j2 writes above the text of closed.c, where that is read by itself. */
#include "../name.h"

#include "../real.h"

/* The pulses of output o are first_pulse[o] ... first_pulse[o + 1] - 1, in order of start; so on for families, powers. */
extern const int first_pulse[];
extern const real start[];
extern const real excess[];
extern const int first_family[];
extern const real rate[];
extern const int first_power[];
extern const real coefficient[];
