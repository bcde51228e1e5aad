/* simulation.h: a stream as FMI drives it, whatever the version: time, phases, values by reference, what is kept.
 * Plain C that is the same for every scene; what a scene is stands in model.h. fmi2.c and fmi3.c each contain it. */
#ifndef SIMULATION_H
#define SIMULATION_H

#include "model.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a call comes to; `said` has the reason for all but FINE. */
typedef enum { FINE, LOSING, WRONG } verdict;

typedef enum { MADE, INITIALIZING, STEPPING, OVER } phase;

/* All that changes. Plain data: a copy of it is a state to come back to. */
typedef struct {
    double start; /* the times of the simulator at tau = 0, */
    double stop;  /* beyond which no step goes, */
    double time;  /* and now */
    double input[INPUTS + 1];
    double output[OUTPUTS];
    double parameter[PARAMETERS + 1];
    int unmade; /* whether parameters were set that the stream does not have yet */
    int phase;
    int linear; /* whether inputs go in straight lines, and are not held */
    int stale;  /* whether outputs may have changed since they were computed */
    int losing; /* whether it has been said that more may be lost than the tolerance */
    stream_state stream;
} situation;

typedef struct {
    situation now;
    stream_state trial; /* for outputs that follow inputs at once */
    char said[256];
} simulation;

/* As bytes: what it belongs to, a check of what follows, and the situation. */
enum {
    CHECK_PLACE = sizeof TOKEN,
    KEPT_PLACE = CHECK_PLACE + sizeof(uint64_t),
    KEPT_SIZE = KEPT_PLACE + sizeof(situation)
};

static int is_number(double x)
{
    return x - x == 0;
}

static verdict refuse(simulation *s, const char *what, double given, const char *expected)
{
    snprintf(s->said, sizeof s->said, "%s: %.17g given, %s expected", what, given, expected);
    return WRONG;
}

/* A call that is made too early or too late. */
static verdict need(simulation *s, int allowed, const char *call)
{
    static const char *const names[] = {"instantiated", "in initialization", "ready to step", "terminated"};
    if (allowed) {
        return FINE;
    }
    snprintf(s->said, sizeof s->said, "%s: called while %s", call, names[s->now.phase]);
    return WRONG;
}

static double to_tau(const situation *now, double time)
{
    return (time - now->start) / SECONDS_PER_TAU;
}

/* The stream starts anew with parameters that were set. */
static verdict make(simulation *s)
{
    if (s->now.unmade && stream_start(&s->now.stream, s->now.parameter) != 0) {
        snprintf(s->said, sizeof s->said,
                 "parameters: bodies too light, or springs too stiff, for the degree of this model (generate it of a scene "
                 "with such parameters)");
        return WRONG;
    }
    s->now.unmade = 0;
    return FINE;
}

/* Outputs as they are with the inputs of now, where these act at once; what is tried is no part of the stream. */
static verdict refresh(simulation *s)
{
    const int follows = s->now.phase < STEPPING || (DIRECT && !s->now.linear);
    if (make(s) != FINE) {
        return WRONG;
    }
    if (s->now.stale && !STEPPED && follows) {
        memcpy(&s->trial, &s->now.stream, stream_used(&s->now.stream));
        stream_step(&s->trial, 0, s->now.input, s->now.output);
    }
    s->now.stale = 0;
    return FINE;
}

static void reset(simulation *s)
{
    static const double values[] = PARAMETER_VALUES;
    memset(s, 0, sizeof *s);
    s->now.stop = HUGE_VAL;
    s->now.linear = LINEAR;
    for (int k = 0; k < PARAMETERS; ++k) {
        s->now.parameter[k] = values[k];
    }
    s->now.unmade = 1;
    s->now.stale = 1;
    (void)refresh(s);
}

static verdict set_times(simulation *s, double start, int has_stop, double stop)
{
    if (need(s, s->now.phase == MADE, "setting up the experiment") != FINE) {
        return WRONG;
    }
    if (!is_number(start)) {
        return refuse(s, "startTime", start, "a finite number");
    }
    if (has_stop && !(stop >= start)) {
        return refuse(s, "stopTime", stop, "a number not below startTime");
    }
    s->now.start = start;
    s->now.time = start;
    s->now.stop = has_stop ? stop : HUGE_VAL;
    return FINE;
}

/* From one phase into another, where it is in that one. */
static verdict enter(simulation *s, phase before, phase after, const char *call)
{
    const verdict allowed = need(s, s->now.phase == (int)before, call);
    s->now.phase = allowed == FINE ? (int)after : s->now.phase;
    return allowed;
}

static verdict begin(simulation *s)
{
    return enter(s, MADE, INITIALIZING, "entering initialization");
}

static verdict finish(simulation *s)
{
    return enter(s, STEPPING, OVER, "terminating");
}

/* Inputs have their first values from the start on. */
static verdict ready(simulation *s)
{
    if (need(s, s->now.phase == INITIALIZING, "leaving initialization") != FINE || make(s) != FINE) {
        return WRONG;
    }
    if (STEPPED) {
        for (int j = 0; j < INPUTS; ++j) {
            s->now.stream.load[j] = s->now.input[j];
        }
    } else {
        stream_step(&s->now.stream, 0, s->now.input, s->now.output);
    }
    s->now.stale = 0;
    s->now.phase = STEPPING;
    return FINE;
}

/* A step that cannot be gone on from. */
static verdict outgrown(simulation *s)
{
    snprintf(s->said, sizeof s->said, "doStep: outputs have grown beyond all numbers, a reset expected");
    return WRONG;
}

/* A stream that goes on in equal steps: as many of them as there are in dtau. */
static verdict march(simulation *s, double dtau)
{
    const double count = STEPPED ? dtau / STEP_LENGTH : 0;
    const int steps = count > 0.5 && count < 1e6 ? (int)(count + 0.5) : 0;
    const double all = steps > 0 ? steps : 1;
    double from[INPUTS + 1];
    double load[INPUTS + 1];
    if (steps < 1 || fabs(count - steps) > 1e-6 * all) {
        snprintf(s->said, sizeof s->said, "communicationStepSize: %.17g given, a whole multiple of %.17g expected",
                 dtau * SECONDS_PER_TAU, STEP_LENGTH * SECONDS_PER_TAU);
        return WRONG;
    }
    for (int j = 0; j < INPUTS; ++j) {
        s->now.stream.load[j] = s->now.linear ? s->now.stream.load[j] : s->now.input[j];
        from[j] = s->now.stream.load[j];
    }
    for (int k = 1; k <= steps; ++k) {
        for (int j = 0; j < INPUTS; ++j) {
            load[j] = k < steps ? from[j] + (s->now.input[j] - from[j]) * (k / all) : s->now.input[j];
        }
        if (stream_step(&s->now.stream, STEP_LENGTH, load, s->now.output) == 2) {
            return outgrown(s);
        }
    }
    return FINE;
}

/* One that goes any way. */
static verdict flow(simulation *s, double dtau)
{
    int status;
    if (!(dtau >= STEP_LEAST && dtau <= STEP_MOST)) {
        snprintf(s->said, sizeof s->said, "communicationStepSize: %.17g given, %.3g to %.3g expected",
                 dtau * SECONDS_PER_TAU, STEP_LEAST * SECONDS_PER_TAU, STEP_MOST * SECONDS_PER_TAU);
        return WRONG;
    }
    if (!s->now.linear) {
        stream_step(&s->now.stream, 0, s->now.input, s->now.output);
    }
    status = stream_step(&s->now.stream, dtau, s->now.input, s->now.output);
    for (int output = 0; output < OUTPUTS; ++output) {
        if (!is_number(s->now.output[output])) {
            return outgrown(s);
        }
    }
    if (status == 2 && !s->now.losing) {
        s->now.losing = 1;
        snprintf(s->said, sizeof s->said,
                 "inputs changed at more instants than there is room for, or fronts have grown steep: more may be lost than "
                 "the tolerance, %.2g of an output at most (steps of whole panels, %.17g long, help, or a model made for "
                 "these instants)",
                 stream_lost(&s->now.stream), PANEL * SECONDS_PER_TAU);
        return LOSING;
    }
    return FINE;
}

/* From `at`, which is now, on by `step`. Times are differences of the simulator's own, so that nothing adds up. */
static verdict advance(simulation *s, double at, double step)
{
    const double then = at + step;
    verdict done;
    if (need(s, s->now.phase == STEPPING, "doStep") != FINE) {
        return WRONG;
    }
    if (!is_number(step) || !(step > 0)) {
        return refuse(s, "communicationStepSize", step, "a positive number");
    }
    if (!(fabs(at - s->now.time) <= 1e-6 * step + 1e-12 * fabs(s->now.time))) {
        snprintf(s->said, sizeof s->said, "currentCommunicationPoint: %.17g given, %.17g expected", at, s->now.time);
        return WRONG;
    }
    if (!(then - s->now.stop <= 1e-6 * step)) {
        return refuse(s, "the end of the step", then, "a time up to stopTime");
    }
    done = STEPPED ? march(s, step / SECONDS_PER_TAU) : flow(s, to_tau(&s->now, then) - to_tau(&s->now, s->now.time));
    if (done != WRONG) {
        s->now.time = then;
        s->now.stale = 0;
    }
    return done;
}

static verdict unknown(simulation *s, unsigned reference, const char *kind)
{
    snprintf(s->said, sizeof s->said, "value reference %u: not that of %s", reference, kind);
    return WRONG;
}

static verdict get_reals(simulation *s, const unsigned *reference, size_t count, double *value)
{
    static const double constant[] = CONSTANTS;
    for (size_t k = 0; k < count; ++k) {
        const unsigned r = reference[k];
        if (r >= LINEAR_REFERENCE) {
            return unknown(s, r, "a number");
        }
        if (r >= FIRST_OUTPUT && r < FIRST_CONSTANT && refresh(s) != FINE) {
            return WRONG;
        }
        if (r == TIME_REFERENCE) {
            value[k] = s->now.time;
        } else if (r < FIRST_OUTPUT) {
            value[k] = s->now.input[r - FIRST_INPUT];
        } else if (r < LOST_REFERENCE) {
            value[k] = s->now.output[r - FIRST_OUTPUT];
        } else if (r < FIRST_CONSTANT) {
            value[k] = stream_lost(&s->now.stream);
        } else {
            value[k] = r < FIRST_PARAMETER ? constant[r - FIRST_CONSTANT] : s->now.parameter[r - FIRST_PARAMETER];
        }
    }
    return FINE;
}

static int is_parameter(unsigned reference)
{
    return reference >= FIRST_PARAMETER && reference < LINEAR_REFERENCE;
}

/* Whether a value may be set: inputs at any time, parameters before the first step. */
static verdict allowed(simulation *s, unsigned reference, double value)
{
    static const char *const names[] = PARAMETER_NAMES;
    static const int positive[] = PARAMETER_POSITIVE;
    if (is_parameter(reference)) {
        const unsigned k = reference - FIRST_PARAMETER;
        if (need(s, s->now.phase <= INITIALIZING, "setting a fixed parameter") != FINE) {
            return WRONG;
        }
        if (!is_number(value) || (positive[k] && !(value > 0))) {
            return refuse(s, names[k], value, positive[k] ? "a positive number" : "a finite number");
        }
        return FINE;
    }
    if (reference < FIRST_INPUT || reference >= FIRST_OUTPUT) {
        return unknown(s, reference, PARAMETERS > 0 ? "an input or a parameter" : "an input");
    }
    return is_number(value) ? FINE : refuse(s, "an input", value, "a finite number");
}

/* All of them, or, where one is wrong, none. */
static verdict set_reals(simulation *s, const unsigned *reference, size_t count, const double *value)
{
    if (need(s, s->now.phase != OVER, "setting a value") != FINE) {
        return WRONG;
    }
    for (size_t k = 0; k < count; ++k) {
        if (allowed(s, reference[k], value[k]) != FINE) {
            return WRONG;
        }
    }
    for (size_t k = 0; k < count; ++k) {
        if (is_parameter(reference[k])) {
            s->now.parameter[reference[k] - FIRST_PARAMETER] = value[k];
            s->now.unmade = 1;
        } else {
            s->now.input[reference[k] - FIRST_INPUT] = value[k];
        }
        s->now.stale = 1;
    }
    return FINE;
}

/* Whether all of them are true or false, and, if they are to be set, may be. */
static verdict may_be_linear(simulation *s, const unsigned *reference, size_t count, int setting)
{
    for (size_t k = 0; k < count; ++k) {
        if (reference[k] != LINEAR_REFERENCE) {
            return unknown(s, reference[k], "a parameter that is true or false");
        }
    }
    return setting && count > 0 ? need(s, s->now.phase <= INITIALIZING, "setting a fixed parameter") : FINE;
}

/* What a model has none of. */
static verdict lack(simulation *s, const char *what)
{
    snprintf(s->said, sizeof s->said, "%s: asked for, but this model has none", what);
    return WRONG;
}

/* A state: into memory that is there already, or new memory. */
static verdict keep(simulation *s, const situation *now, void **state)
{
    if (*state == NULL) {
        *state = malloc(sizeof *now);
    }
    if (*state == NULL) {
        return lack(s, "memory");
    }
    memcpy(*state, now, sizeof *now);
    return FINE;
}

static verdict put_back(simulation *s, const void *state)
{
    if (state == NULL) {
        return lack(s, "a state at NULL");
    }
    memcpy(&s->now, state, sizeof s->now);
    return FINE;
}

static void give_up(void **state)
{
    if (state) {
        free(*state);
        *state = NULL;
    }
}

/* FNV-1a */
static uint64_t checksum(const situation *kept)
{
    const unsigned char *const bytes = (const unsigned char *)kept;
    uint64_t hash = 14695981039346656037u;
    for (size_t k = 0; k < sizeof *kept; ++k) {
        hash = (hash ^ bytes[k]) * 1099511628211u;
    }
    return hash;
}

static verdict serialize(simulation *s, const void *state, void *bytes, size_t size)
{
    const situation *const kept = (const situation *)state;
    char *const to = (char *)bytes;
    uint64_t check;
    if (kept == NULL) {
        return lack(s, "a state at NULL");
    }
    if (size < KEPT_SIZE) {
        return refuse(s, "size of a serialized state", (double)size, "that which is told");
    }
    check = checksum(kept);
    memcpy(to, TOKEN, sizeof TOKEN);
    memcpy(to + CHECK_PLACE, &check, sizeof check);
    memcpy(to + KEPT_PLACE, kept, sizeof *kept);
    return FINE;
}

/* What is not a state of this scene, as this program has it, or has been changed, is refused. */
static verdict deserialize(simulation *s, const void *bytes, size_t size, void **state)
{
    const char *const from = (const char *)bytes;
    situation *const kept = (situation *)malloc(sizeof *kept);
    uint64_t check = 0;
    verdict found;
    if (kept == NULL) {
        return lack(s, "memory");
    }
    if (size == KEPT_SIZE) {
        memcpy(&check, from + CHECK_PLACE, sizeof check);
        memcpy(kept, from + KEPT_PLACE, sizeof *kept);
    }
    if (size != KEPT_SIZE || memcmp(from, TOKEN, sizeof TOKEN) != 0 || check != checksum(kept)) {
        snprintf(s->said, sizeof s->said, "a serialized state: not one of this model, or damaged");
        found = WRONG;
    } else {
        found = keep(s, kept, state);
    }
    free(kept);
    return found;
}

#endif
