/* tables.h: stands for what runtime.c.j2 writes above the texts of these files, where they are read by themselves. */
#define TABLES
#include "../name.h"

enum {
    NAME_WINDOWS = 9,
    NAME_STRANDS = 4,
    NAME_DEGREE = 40,
    NAME_PANELS = 2,
    NAME_JOINTS = 3,
    NAME_POINTS = 4,
    NAME_STATES = 3,
    NAME_SQUARES = 4,
    NAME_BODIES = 1,
    NAME_WIDEST = 2,
    NAME_PORTS = 4,
    NAME_TRACKS = 4,
    NAME_SLOTS = 9,
    NAME_FORCES = 1,
    NAME_GAINS = 4,
    NAME_EVENTS = 3,
    NAME_LANES = 3,
    NAME_GROUPS = 6
};

#include "models.h"
#include "peaks.h"
#include "gradients.h"
#include "batches.h"
#include "misfits.h"
#include "bounds.h"

struct name_parameters {
    name_real mass[3];
};

#include "wide.h"
#define num name_real
#define OF(name) name_##name
#include "set.h"
#undef num
#undef OF
#include "work.h"
struct name_model {
#include "model.h"
};
#include "tangent.h"
#include "batch.h"
#include "data.h"

#include <float.h>

#include "../real.h"
#include "../vectors.h"

enum { LEAST = 8, LOAD_LANE = -1, SECTIONS = 3, CYCLE = 2 };

#define num real
#define OF(name) name
#include "laws.h"
#undef num
#undef OF

int good(const name_parameters *p);
int good_for_slopes(const name_parameters *p);
void laws_of(const name_parameters *p, laws *law);
int laws_within_reach(const laws *law);
void slopes_of(const name_parameters *p, int lane, laws *law);

extern const real largest_number;
extern const real least_number;
/* what a window may miss, of the largest wave; a rounding */
extern const real share;
extern const real unit;
/* a law that is less is rounded by less than a rounding of this: it may have underflowed */
extern const real faint;
/* how often a law is rounded, at most */
extern const real roundings;
/* how long a window is, and CYCLE of them */
extern const real window_length;
extern const real span;

#include "../ports.h"
/* where the matrices of a joint begin; those of blocks at_square, too */
extern const int at_rates[];
extern const int at_square[];
extern const int at_pushed[];
extern const int at_shown[];
extern const int at_passed[];
/* bodies, one mass without springs: which joint each is, and whether a joint is one */
extern const int body_joint[];
extern const int is_body[];
/* of a track how many windows it takes, and where its ring begins */
extern const int steps[];
extern const int ring[];
/* whether a state is a velocity */
extern const int is_mass[];
/* half the length of a panel; how long before its start another one began last: since_panel[panel*PANELS + other] */
extern const real half_length[];
extern const real since_panel[];
/* changes of loads, in order: a weight times an amplitude times a strength is added to a power of the time since, or
 * where 3 is added to this power stands for all that acted before */
extern const int event_window[];
extern const int event_panel[];
extern const int event_force[];
extern const int event_power[];
extern const real event_weight[];
extern const int event_strength[];
extern const int event_load[];
/* sections of the windows of a cycle, from which t on; an output on one is a sum of strands:
 * first_strand[section*OUTPUTS + output] */
extern const real from[];
extern const int first_strand[];
extern const int strand_at[];
/* strands of a section that are read together, one behind the other: at the same instants, each of another output
 * (strand_output), which one before is of where there is `more` */
extern const int strand_output[];
extern const int first_reading[];
extern const int reading_strand[];
extern const int reading_strands[];
extern const int reading_more[];
/* strands: u = (t - start + excess) * scale - 1, start and excess for each window of a cycle */
extern const real strand_start[];
extern const real strand_excess[];
extern const real strand_scale[];
/* what a strand is the sum of: times which gain, which track, where it is, and from which u to which its integral goes */
extern const int first_term[];
extern const int term_gain[];
extern const int term_track[];
extern const int term_back[];
extern const int term_panel[];
extern const int term_summed[];
extern const real term_low[];
extern const real term_high[];
/* gains: of which output each is */
extern const int gain_output[];
/* outputs: whether it is 0 whatever the parameters are */
extern const int is_zero[];
/* amplitudes of the loads, where they are no parameters */
extern const real amplitude[];
