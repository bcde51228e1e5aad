/* tables.h: stands for what plain.c.j2 writes above the text of modes.c, where that is read by itself. */
#include "../name.h"

enum { NAME_MODES = 24, NAME_LOADS = 2 };

#include "state.h"

#include "../real.h"

enum { OUTPUTS = NAME_OUTPUTS, MODES = NAME_MODES, LOADS = NAME_LOADS, LANES = 8, MOVED = 2, MOVING = 1 };

void name_init(name_state *state);
int name_step(name_state *state, real dtau, const real *load, real *out);

extern const real spacing;
/* A step outside of these is not the spacing, rounded. */
extern const real shortest;
extern const real longest;

/* by mode */
extern const real p11[];
extern const real p12[];
extern const real p21[];
extern const real p22[];
/* by load, then by mode */
extern const real one0[];
extern const real one1[];
extern const real speed0[];
extern const real speed1[];
/* The outputs that y counts in; LANES of them at a time, by mode, their weights. */
extern const int moved_row[];
extern const real moved_weight[];
/* The same for v. */
extern const int moving_row[];
extern const real moving_weight[];
/* What a load, its integral and the integral of that count in an output: by output, then by load. */
extern const real load_weight[];
