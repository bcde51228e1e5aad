/* tables.h: stands for what pieces.c.j2 writes above the text of pieces.c, where that is read by itself. */
#include "../name.h"

#include "../real.h"

enum { GRIDS = 2 };

extern const real exact;

extern const int first_member[];
extern const int member[];
extern const int first_piece[];
extern const real start[];
extern const real centre[];
extern const int first_part[];
extern const real scale[];
extern const int part[];
extern const int first_power[];
extern const real coefficient[];
