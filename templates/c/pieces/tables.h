/* tables.h: stands for what plain.c.j2 writes above the text of pieces.c, where that is read by itself. */
#include "../name.h"

#include "../real.h"
#include "../vectors.h"

enum { GRIDS = 2, STEPS = 1 };

/* Of grid g: its outputs member[first_member[g]] ... up to first_member[g + 1], and so on; the starts of its pieces
 * start at first_piece[g] + g, as there is one more, the end of the last piece. */
extern const int first_member[];
extern const int member[];
extern const int first_piece[];
extern const real start[];
extern const real centre[];
/* Where to look for tau: from the piece at part (int)(tau * scale) of the grid, STEPS pieces onward at most. */
extern const int first_part[];
extern const real scale[];
extern const int part[];
/* The polynomials of piece p of all grids from coefficient[first_power[p]] on: highest power first, of each power those
 * of all members. */
extern const int first_power[];
extern const real coefficient[];

/* Up to here numbers of samples are exact. */
extern const real exact;
