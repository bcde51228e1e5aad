/* tables.h: stands for what joints.c.j2 writes above the text of joints.c, where that is read by itself. */
#include <stddef.h>

#ifdef SINGLE
typedef float name_real;
#else
typedef double name_real;
#endif

#define NAME_TAU_MAX ((name_real)8)
#define NAME_JOINTED

enum {
    NAME_OUTPUTS = 2,
    NAME_WINDOWS = 9,
    NAME_STRANDS = 4,
    NAME_DEGREE = 40,
    NAME_PANELS = 2,
    NAME_JOINTS = 3,
    NAME_POINTS = 4,
    NAME_STATES = 3,
    NAME_SQUARES = 5,
    NAME_WIDEST = 2,
    NAME_PORTS = 4,
    NAME_TRACKS = 4,
    NAME_SLOTS = 9,
    NAME_FORCES = 1,
    NAME_HEARD = 4,
    NAME_EVENTS = 3,
    NAME_LANES = 3,
    NAME_GROUPS = 6
};

#include "model.h"
#include "batch.h"
#include "../runtime/data.h"

typedef struct {
    name_real mass[3];
} name_parameters;

int name_build(name_model *model, const name_parameters *parameters);
name_real name_error_estimate(const name_model *model);
int name_error_bound(name_model *model, const name_parameters *parameters, name_real *bound);
int name_model_eval(const name_model *model, name_real tau, name_real *out);
int name_model_sample(const name_model *model, name_real tau0, name_real dtau, size_t count, name_real *out);
int name_build_tangent(name_tangent *tangent, const name_parameters *parameters);
int name_tangent_sample(
    const name_tangent *tangent, name_real tau0, name_real dtau, size_t count, name_real *out);

#include <float.h>

#include "../real.h"

typedef name_model model_of;

enum { LEAST = 8, LOAD_LANE = -1, SECTIONS = 3, CYCLE = 2, JOINTED = 1 };

/* What parameters make of joints, rods, loads and outputs. */
typedef struct {
    real rates[5 + 1];
    real pushed[5 + 1];
    real shown[5 + 1];
    real passed[5 + 1];
    real push[4 + 1];
    real held[4 + 1];
    real begun[3 + 1];
    real weight[3 + 1];
    real impedance[4 + 1];
    real strength[1 + 1];
    real gain[4 + 1];
    const real *load;
} laws;

/* The same of each set in its lane. */
typedef struct {
    name_wide rates[5 + 1];
    name_wide pushed[5 + 1];
    name_wide shown[5 + 1];
    name_wide passed[5 + 1];
    name_wide push[4 + 1];
    name_wide held[4 + 1];
    name_wide begun[3 + 1];
    name_wide weight[3 + 1];
    name_wide impedance[4 + 1];
    name_wide strength[1 + 1];
    name_wide gain[4 + 1];
} laws_batch;

int good(const name_parameters *p);
int good_for_slopes(const name_parameters *p);
void laws_of(const name_parameters *p, laws *law);
int laws_within_reach(const laws *law);
void slopes_of(const name_parameters *p, int lane, laws *law);
void spread(laws_batch *all, int set, const laws *law);

extern const real largest_number;
extern const real least_number;
extern const real faint;
extern const int silent[];
extern const real roundings;
extern const real share;
extern const real unit;
extern const real window_length;
extern const real span;

extern const int first_point[];
extern const int first_state[];
extern const int first_port[];
extern const int at_rates[];
extern const int at_pushed[];
extern const int at_shown[];
extern const int at_passed[];
extern const int point_of[];
extern const real ratio[];
extern const int arrive[];
extern const int send[];
extern const int steps[];
extern const int ring[];
extern const int is_mass[];
extern const real half_length[];
extern const real since_panel[];
extern const int force_on[];
extern const int event_window[];
extern const int event_panel[];
extern const int event_force[];
extern const int event_power[];
extern const real event_weight[];
extern const int event_strength[];
extern const int event_load[];
extern const real from[];
extern const int first_strand[];
extern const int strand_at[];
extern const real strand_start[];
extern const real strand_excess[];
extern const real strand_scale[];
extern const int first_term[];
extern const int term_heard[];
extern const int term_track[];
extern const int term_back[];
extern const int term_panel[];
extern const int term_summed[];
extern const real term_low[];
extern const real term_high[];
extern const int heard_output[];
