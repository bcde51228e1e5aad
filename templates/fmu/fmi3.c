/* fmi3.c: simulation.h as FMI 3.0 calls it, for co-simulation. Errors and warnings are logged always, and nothing else. */
#include "fmi3.h"
#include "simulation.h"

typedef struct {
    simulation run;
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
} instance;

static fmi3Status answer(instance *it, verdict found)
{
    const fmi3Status status = found == FINE ? fmi3OK : found == LOSING ? fmi3Warning : fmi3Error;
    if (status != fmi3OK && it->log) {
        it->log(it->environment, status, status == fmi3Warning ? "logStatusWarning" : "logStatusError", it->run.said);
    }
    return status;
}

/* What this model has none of. */
static fmi3Status none(fmi3Instance of, const char *what)
{
    instance *const it = (instance *)of;
    snprintf(it->run.said, sizeof it->run.said, "%s: asked for, but this model has none", what);
    return answer(it, WRONG);
}

/* All variables are single numbers: as many values as references. */
static verdict single(simulation *s, size_t references, size_t count)
{
    return references == count ? FINE : refuse(s, "nValues", (double)count, "as many as references");
}

const char *FMI3(fmi3GetVersion)(void)
{
    return "3.0";
}

fmi3Status FMI3(fmi3SetDebugLogging)(fmi3Instance it, fmi3Boolean on, size_t count, const fmi3String categories[])
{
    (void)it;
    (void)on;
    (void)count;
    (void)categories;
    return fmi3OK;
}

fmi3Instance FMI3(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events,
                                               fmi3Boolean early, const fmi3ValueReference intermediate[],
                                               size_t intermediates, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    const char *wrong = "not enough memory";
    instance *it = NULL;
    (void)name;
    (void)resources;
    (void)visible;
    (void)logging;
    (void)early;
    (void)intermediate;
    (void)update;
    if (token == NULL || strcmp(token, TOKEN) != 0) {
        wrong = "instantiationToken: not that of this model";
    } else if (events || intermediates > 0) {
        wrong = "eventModeUsed, requiredIntermediateVariables: asked for, but this model has none";
    } else {
        it = (instance *)calloc(1, sizeof *it);
    }
    if (it == NULL) {
        if (log) {
            log(environment, fmi3Error, "logStatusError", wrong);
        }
        return NULL;
    }
    it->log = log;
    it->environment = environment;
    reset(&it->run);
    return it;
}

fmi3Instance FMI3(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                fmi3Boolean visible, fmi3Boolean logging,
                                                fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    (void)name;
    (void)token;
    (void)resources;
    (void)visible;
    (void)logging;
    if (log) {
        log(environment, fmi3Error, "logStatusError", "model exchange: asked for, co-simulation expected");
    }
    return NULL;
}

fmi3Instance FMI3(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token, fmi3String resources,
                                                     fmi3Boolean visible, fmi3Boolean logging,
                                                     fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                                     fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                                     fmi3UnlockPreemptionCallback unlock)
{
    (void)update;
    (void)lock;
    (void)unlock;
    return FMI3(fmi3InstantiateModelExchange)(name, token, resources, visible, logging, environment, log);
}

void FMI3(fmi3FreeInstance)(fmi3Instance it)
{
    free(it);
}

fmi3Status FMI3(fmi3EnterInitializationMode)(fmi3Instance of, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                             fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop)
{
    instance *const it = (instance *)of;
    const verdict found = set_times(&it->run, start, has_stop, stop);
    (void)has_tolerance;
    (void)tolerance;
    return answer(it, found == FINE ? begin(&it->run) : found);
}

fmi3Status FMI3(fmi3ExitInitializationMode)(fmi3Instance it)
{
    return answer((instance *)it, ready(&((instance *)it)->run));
}

fmi3Status FMI3(fmi3Terminate)(fmi3Instance it)
{
    return answer((instance *)it, finish(&((instance *)it)->run));
}

fmi3Status FMI3(fmi3Reset)(fmi3Instance it)
{
    reset(&((instance *)it)->run);
    return fmi3OK;
}

FMI3_GET(Float64)
{
    simulation *const s = &((instance *)it)->run;
    const verdict fit = single(s, references, count);
    return answer((instance *)it, fit == FINE ? get_reals(s, reference, references, value) : fit);
}

FMI3_SET(Float64)
{
    simulation *const s = &((instance *)it)->run;
    const verdict fit = single(s, references, count);
    return answer((instance *)it, fit == FINE ? set_reals(s, reference, references, value) : fit);
}

FMI3_GET(Boolean)
{
    simulation *const s = &((instance *)it)->run;
    verdict found = single(s, references, count);
    for (size_t k = 0; k < references && found == FINE; ++k) {
        found = reference[k] == LINEAR_REFERENCE ? FINE : unknown(s, reference[k], "a parameter that is true or false");
        if (found == FINE) {
            value[k] = s->now.linear != 0;
        }
    }
    return answer((instance *)it, found);
}

FMI3_SET(Boolean)
{
    simulation *const s = &((instance *)it)->run;
    verdict found = single(s, references, count);
    for (size_t k = 0; k < references && found == FINE; ++k) {
        found = may_be_linear(s, reference[k]);
    }
    for (size_t k = 0; k < references && found == FINE; ++k) {
        s->now.linear = value[k];
    }
    return answer((instance *)it, found);
}

/* There are no values of other types. */
#define NONE(macro, type) \
    macro(type) \
    { \
        (void)reference; \
        (void)value; \
        (void)count; \
        return references ? none(it, "a variable of type " #type) : fmi3OK; \
    }

NONE(FMI3_GET, Float32)
NONE(FMI3_GET, Int8)
NONE(FMI3_GET, UInt8)
NONE(FMI3_GET, Int16)
NONE(FMI3_GET, UInt16)
NONE(FMI3_GET, Int32)
NONE(FMI3_GET, UInt32)
NONE(FMI3_GET, Int64)
NONE(FMI3_GET, UInt64)
NONE(FMI3_GET, String)
NONE(FMI3_SET, Float32)
NONE(FMI3_SET, Int8)
NONE(FMI3_SET, UInt8)
NONE(FMI3_SET, Int16)
NONE(FMI3_SET, UInt16)
NONE(FMI3_SET, Int32)
NONE(FMI3_SET, UInt32)
NONE(FMI3_SET, Int64)
NONE(FMI3_SET, UInt64)
NONE(FMI3_SET, String)

fmi3Status FMI3(fmi3GetBinary)(fmi3Instance it, const fmi3ValueReference reference[], size_t references,
                               size_t size[], fmi3Binary value[], size_t count)
{
    (void)reference;
    (void)size;
    (void)value;
    (void)count;
    return references ? none(it, "a variable of type Binary") : fmi3OK;
}

fmi3Status FMI3(fmi3SetBinary)(fmi3Instance it, const fmi3ValueReference reference[], size_t references,
                               const size_t size[], const fmi3Binary value[], size_t count)
{
    (void)reference;
    (void)size;
    (void)value;
    (void)count;
    return references ? none(it, "a variable of type Binary") : fmi3OK;
}

fmi3Status FMI3(fmi3GetClock)(fmi3Instance it, const fmi3ValueReference reference[], size_t references,
                              fmi3Clock value[])
{
    (void)reference;
    (void)value;
    return references ? none(it, "a clock") : fmi3OK;
}

fmi3Status FMI3(fmi3SetClock)(fmi3Instance it, const fmi3ValueReference reference[], size_t references,
                              const fmi3Clock value[])
{
    (void)reference;
    (void)value;
    return references ? none(it, "a clock") : fmi3OK;
}

fmi3Status FMI3(fmi3GetNumberOfVariableDependencies)(fmi3Instance it, fmi3ValueReference reference, size_t *count)
{
    (void)reference;
    (void)count;
    return none(it, "a list of dependencies while it runs");
}

fmi3Status FMI3(fmi3GetVariableDependencies)(fmi3Instance it, fmi3ValueReference dependent, size_t elements[],
                                             fmi3ValueReference on[], size_t places[], fmi3DependencyKind kind[],
                                             size_t count)
{
    (void)dependent;
    (void)elements;
    (void)on;
    (void)places;
    (void)kind;
    (void)count;
    return none(it, "a list of dependencies while it runs");
}

/* A state: into memory that is there already, or new memory. */
static fmi3Status keep(instance *it, const situation *now, fmi3FMUState *state)
{
    if (*state == NULL) {
        *state = malloc(sizeof *now);
    }
    if (*state == NULL) {
        return none(it, "memory");
    }
    memcpy(*state, now, sizeof *now);
    return fmi3OK;
}

fmi3Status FMI3(fmi3GetFMUState)(fmi3Instance it, fmi3FMUState *state)
{
    return keep((instance *)it, &((instance *)it)->run.now, state);
}

fmi3Status FMI3(fmi3SetFMUState)(fmi3Instance it, fmi3FMUState state)
{
    if (state == NULL) {
        return none(it, "a state at NULL");
    }
    memcpy(&((instance *)it)->run.now, state, sizeof(situation));
    return fmi3OK;
}

fmi3Status FMI3(fmi3FreeFMUState)(fmi3Instance it, fmi3FMUState *state)
{
    (void)it;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

fmi3Status FMI3(fmi3SerializedFMUStateSize)(fmi3Instance it, fmi3FMUState state, size_t *size)
{
    (void)it;
    (void)state;
    *size = KEPT_SIZE;
    return fmi3OK;
}

fmi3Status FMI3(fmi3SerializeFMUState)(fmi3Instance of, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    instance *const it = (instance *)of;
    return state ? answer(it, serialize(&it->run, (const situation *)state, bytes, size)) : none(it, "a state at NULL");
}

fmi3Status FMI3(fmi3DeserializeFMUState)(fmi3Instance of, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    instance *const it = (instance *)of;
    situation *const kept = (situation *)malloc(sizeof *kept);
    fmi3Status status;
    if (kept == NULL) {
        return none(it, "memory");
    }
    status = answer(it, deserialize(&it->run, bytes, size, kept));
    status = status == fmi3OK ? keep(it, kept, state) : status;
    free(kept);
    return status;
}

fmi3Status FMI3(fmi3DoStep)(fmi3Instance of, fmi3Float64 at, fmi3Float64 step, fmi3Boolean never_back,
                            fmi3Boolean *event, fmi3Boolean *end, fmi3Boolean *early, fmi3Float64 *reached)
{
    instance *const it = (instance *)of;
    const fmi3Status status = answer(it, advance(&it->run, at, step));
    (void)never_back;
    *event = false;
    *end = false;
    *early = false;
    *reached = it->run.now.time;
    return status;
}

fmi3Status FMI3(fmi3GetDirectionalDerivative)(fmi3Instance it, const fmi3ValueReference unknown[], size_t unknowns,
                                              const fmi3ValueReference known[], size_t knowns,
                                              const fmi3Float64 seed[], size_t seeds, fmi3Float64 product[],
                                              size_t products)
{
    (void)unknown;
    (void)unknowns;
    (void)known;
    (void)knowns;
    (void)seed;
    (void)seeds;
    (void)product;
    (void)products;
    return none(it, "a directional derivative");
}

fmi3Status FMI3(fmi3GetAdjointDerivative)(fmi3Instance it, const fmi3ValueReference unknown[], size_t unknowns,
                                          const fmi3ValueReference known[], size_t knowns, const fmi3Float64 seed[],
                                          size_t seeds, fmi3Float64 product[], size_t products)
{
    (void)unknown;
    (void)unknowns;
    (void)known;
    (void)knowns;
    (void)seed;
    (void)seeds;
    (void)product;
    (void)products;
    return none(it, "an adjoint derivative");
}

fmi3Status FMI3(fmi3EnterConfigurationMode)(fmi3Instance it)
{
    return none(it, "a structural parameter");
}

fmi3Status FMI3(fmi3ExitConfigurationMode)(fmi3Instance it)
{
    return none(it, "a structural parameter");
}

fmi3Status FMI3(fmi3EnterEventMode)(fmi3Instance it)
{
    return none(it, "an event");
}

fmi3Status FMI3(fmi3EnterStepMode)(fmi3Instance it)
{
    return none(it, "an event");
}

fmi3Status FMI3(fmi3EvaluateDiscreteStates)(fmi3Instance it)
{
    return none(it, "a discrete state");
}

fmi3Status FMI3(fmi3UpdateDiscreteStates)(fmi3Instance it, fmi3Boolean *again, fmi3Boolean *end,
                                          fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *defined,
                                          fmi3Float64 *next)
{
    (void)again;
    (void)end;
    (void)nominals;
    (void)values;
    (void)defined;
    (void)next;
    return none(it, "a discrete state");
}

fmi3Status FMI3(fmi3GetIntervalDecimal)(fmi3Instance it, const fmi3ValueReference reference[], size_t references,
                                        fmi3Float64 interval[], fmi3IntervalQualifier qualifier[])
{
    (void)reference;
    (void)references;
    (void)interval;
    (void)qualifier;
    return none(it, "a clock");
}

fmi3Status FMI3(fmi3GetIntervalFraction)(fmi3Instance it, const fmi3ValueReference reference[], size_t references,
                                         fmi3UInt64 counter[], fmi3UInt64 resolution[],
                                         fmi3IntervalQualifier qualifier[])
{
    (void)reference;
    (void)references;
    (void)counter;
    (void)resolution;
    (void)qualifier;
    return none(it, "a clock");
}

#define NO_DECIMAL(function, type) \
    fmi3Status FMI3(function)(fmi3Instance it, const fmi3ValueReference reference[], size_t references, type times[]) \
    { \
        (void)reference; \
        (void)references; \
        (void)times; \
        return none(it, "a clock"); \
    }

#define NO_FRACTION(function, type) \
    fmi3Status FMI3(function)(fmi3Instance it, const fmi3ValueReference reference[], size_t references, type counter[], \
                              type resolution[]) \
    { \
        (void)reference; \
        (void)references; \
        (void)counter; \
        (void)resolution; \
        return none(it, "a clock"); \
    }

NO_DECIMAL(fmi3GetShiftDecimal, fmi3Float64)
NO_DECIMAL(fmi3SetShiftDecimal, const fmi3Float64)
NO_DECIMAL(fmi3SetIntervalDecimal, const fmi3Float64)
NO_FRACTION(fmi3GetShiftFraction, fmi3UInt64)
NO_FRACTION(fmi3SetShiftFraction, const fmi3UInt64)
NO_FRACTION(fmi3SetIntervalFraction, const fmi3UInt64)

fmi3Status FMI3(fmi3GetOutputDerivatives)(fmi3Instance it, const fmi3ValueReference reference[], size_t references,
                                          const fmi3Int32 order[], fmi3Float64 value[], size_t count)
{
    (void)reference;
    (void)references;
    (void)order;
    (void)value;
    (void)count;
    return none(it, "a derivative of an output");
}

/* What is of model exchange and of scheduled execution. */
fmi3Status FMI3(fmi3EnterContinuousTimeMode)(fmi3Instance it)
{
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3CompletedIntegratorStep)(fmi3Instance it, fmi3Boolean never_back, fmi3Boolean *event,
                                             fmi3Boolean *end)
{
    (void)never_back;
    (void)event;
    (void)end;
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3SetTime)(fmi3Instance it, fmi3Float64 time)
{
    (void)time;
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3SetContinuousStates)(fmi3Instance it, const fmi3Float64 state[], size_t count)
{
    (void)state;
    (void)count;
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3GetContinuousStateDerivatives)(fmi3Instance it, fmi3Float64 rate[], size_t count)
{
    (void)rate;
    (void)count;
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3GetEventIndicators)(fmi3Instance it, fmi3Float64 indicator[], size_t count)
{
    (void)indicator;
    (void)count;
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3GetContinuousStates)(fmi3Instance it, fmi3Float64 state[], size_t count)
{
    (void)state;
    (void)count;
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3GetNominalsOfContinuousStates)(fmi3Instance it, fmi3Float64 nominal[], size_t count)
{
    (void)nominal;
    (void)count;
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3GetNumberOfEventIndicators)(fmi3Instance it, size_t *count)
{
    (void)count;
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3GetNumberOfContinuousStates)(fmi3Instance it, size_t *count)
{
    (void)count;
    return none(it, "model exchange");
}

fmi3Status FMI3(fmi3ActivateModelPartition)(fmi3Instance it, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock;
    (void)time;
    return none(it, "scheduled execution");
}
