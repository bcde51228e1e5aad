/* fmi3.c: simulation.h as FMI 3.0 calls it, for co-simulation. Errors and warnings are logged always, and nothing else. */
#include "fmi3.h"
#include "simulation.h"

/* What functions are given stands in the standard; not all of it matters here. */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

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
    return answer(it, lack(&it->run, what));
}

/* A call of simulation.h. */
#define CALL(function, arguments, call) \
    FMI3_FUNCTION(fmi3Status, function, arguments) \
    { \
        simulation *const s = &((instance *)it)->run; \
        return answer((instance *)it, call); \
    }

/* Functions and values that this model has none of, though simulators look for their names. */
#define VARIABLES fmi3Instance it, const fmi3ValueReference reference[], size_t references
#define NONE(function, what, arguments) \
    FMI3_FUNCTION(fmi3Status, function, arguments) \
    { \
        return none(it, what); \
    }
#define NO_VALUE(function, what, arguments) \
    FMI3_FUNCTION(fmi3Status, function, arguments) \
    { \
        return references ? none(it, what) : fmi3OK; \
    }

/* All variables are single numbers: as many values as references. */
static verdict single(simulation *s, size_t references, size_t count)
{
    return references == count ? FINE : refuse(s, "nValues", (double)count, "as many as references");
}

FMI3_FUNCTION(const char *, fmi3GetVersion, (void))
{
    return "3.0";
}

FMI3_FUNCTION(fmi3Status, fmi3SetDebugLogging,
              (fmi3Instance it, fmi3Boolean on, size_t count, const fmi3String categories[]))
{
    return fmi3OK;
}

FMI3_FUNCTION(fmi3Instance, fmi3InstantiateCoSimulation,
              (fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
               fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference intermediate[],
               size_t intermediates, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
               fmi3IntermediateUpdateCallback update))
{
    const char *wrong = "not enough memory";
    instance *it = NULL;
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

FMI3_FUNCTION(fmi3Instance, fmi3InstantiateModelExchange,
              (fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log))
{
    if (log) {
        log(environment, fmi3Error, "logStatusError", "model exchange: asked for, co-simulation expected");
    }
    return NULL;
}

FMI3_FUNCTION(fmi3Instance, fmi3InstantiateScheduledExecution,
              (fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
               fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock))
{
    return FMI3(fmi3InstantiateModelExchange)(name, token, resources, visible, logging, environment, log);
}

FMI3_FUNCTION(void, fmi3FreeInstance, (fmi3Instance it))
{
    free(it);
}

FMI3_FUNCTION(fmi3Status, fmi3EnterInitializationMode,
              (fmi3Instance of, fmi3Boolean has_tolerance, fmi3Float64 tolerance, fmi3Float64 start,
               fmi3Boolean has_stop, fmi3Float64 stop))
{
    instance *const it = (instance *)of;
    const verdict found = set_times(&it->run, start, has_stop, stop);
    return answer(it, found == FINE ? begin(&it->run) : found);
}

CALL(fmi3ExitInitializationMode, (fmi3Instance it), ready(s))
CALL(fmi3Terminate, (fmi3Instance it), finish(s))

FMI3_FUNCTION(fmi3Status, fmi3Reset, (fmi3Instance it))
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
    const verdict fit = single(s, references, count);
    const verdict found = fit == FINE ? may_be_linear(s, reference, references, 0) : fit;
    for (size_t k = 0; k < references && found == FINE; ++k) {
        value[k] = s->now.linear != 0;
    }
    return answer((instance *)it, found);
}

FMI3_SET(Boolean)
{
    simulation *const s = &((instance *)it)->run;
    const verdict fit = single(s, references, count);
    const verdict found = fit == FINE ? may_be_linear(s, reference, references, 1) : fit;
    for (size_t k = 0; k < references && found == FINE; ++k) {
        s->now.linear = value[k];
    }
    return answer((instance *)it, found);
}

/* There are no values of other types. */
#define NO_TYPE(type) \
    FMI3_GET(type) \
    { \
        return references ? none(it, "a variable of type " #type) : fmi3OK; \
    } \
    FMI3_SET(type) \
    { \
        return references ? none(it, "a variable of type " #type) : fmi3OK; \
    }

NO_TYPE(Float32)
NO_TYPE(Int8)
NO_TYPE(UInt8)
NO_TYPE(Int16)
NO_TYPE(UInt16)
NO_TYPE(Int32)
NO_TYPE(UInt32)
NO_TYPE(Int64)
NO_TYPE(UInt64)
NO_TYPE(String)

NO_VALUE(fmi3GetBinary, "a variable of type Binary", (VARIABLES, size_t size[], fmi3Binary value[], size_t count))
NO_VALUE(fmi3SetBinary, "a variable of type Binary",
         (VARIABLES, const size_t size[], const fmi3Binary value[], size_t count))
NO_VALUE(fmi3GetClock, "a clock", (VARIABLES, fmi3Clock value[]))
NO_VALUE(fmi3SetClock, "a clock", (VARIABLES, const fmi3Clock value[]))
NONE(fmi3GetNumberOfVariableDependencies, "a list of dependencies while it runs",
     (fmi3Instance it, fmi3ValueReference reference, size_t *count))
NONE(fmi3GetVariableDependencies, "a list of dependencies while it runs",
     (fmi3Instance it, fmi3ValueReference dependent, size_t elements[], fmi3ValueReference on[], size_t places[],
      fmi3DependencyKind kind[], size_t count))
CALL(fmi3GetFMUState, (fmi3Instance it, fmi3FMUState *state), keep(s, &s->now, state))
CALL(fmi3SetFMUState, (fmi3Instance it, fmi3FMUState state), put_back(s, state))

FMI3_FUNCTION(fmi3Status, fmi3FreeFMUState, (fmi3Instance it, fmi3FMUState *state))
{
    give_up(state);
    return fmi3OK;
}

FMI3_FUNCTION(fmi3Status, fmi3SerializedFMUStateSize, (fmi3Instance it, fmi3FMUState state, size_t *size))
{
    *size = KEPT_SIZE;
    return fmi3OK;
}

CALL(fmi3SerializeFMUState, (fmi3Instance it, fmi3FMUState state, fmi3Byte bytes[], size_t size),
     serialize(s, state, bytes, size))
CALL(fmi3DeserializeFMUState, (fmi3Instance it, const fmi3Byte bytes[], size_t size, fmi3FMUState *state),
     deserialize(s, bytes, size, state))

FMI3_FUNCTION(fmi3Status, fmi3DoStep,
              (fmi3Instance of, fmi3Float64 at, fmi3Float64 step, fmi3Boolean never_back, fmi3Boolean *event,
               fmi3Boolean *end, fmi3Boolean *early, fmi3Float64 *reached))
{
    instance *const it = (instance *)of;
    const fmi3Status status = answer(it, advance(&it->run, at, step));
    *event = false;
    *end = false;
    *early = false;
    *reached = it->run.now.time;
    return status;
}

NONE(fmi3GetDirectionalDerivative, "a directional derivative",
     (fmi3Instance it, const fmi3ValueReference unknown[], size_t unknowns, const fmi3ValueReference known[],
      size_t knowns, const fmi3Float64 seed[], size_t seeds, fmi3Float64 product[], size_t products))
NONE(fmi3GetAdjointDerivative, "an adjoint derivative",
     (fmi3Instance it, const fmi3ValueReference unknown[], size_t unknowns, const fmi3ValueReference known[],
      size_t knowns, const fmi3Float64 seed[], size_t seeds, fmi3Float64 product[], size_t products))
NONE(fmi3EnterConfigurationMode, "a structural parameter", (fmi3Instance it))
NONE(fmi3ExitConfigurationMode, "a structural parameter", (fmi3Instance it))
NONE(fmi3EnterEventMode, "an event", (fmi3Instance it))
NONE(fmi3EnterStepMode, "an event", (fmi3Instance it))
NONE(fmi3EvaluateDiscreteStates, "a discrete state", (fmi3Instance it))
NONE(fmi3UpdateDiscreteStates, "a discrete state",
     (fmi3Instance it, fmi3Boolean *again, fmi3Boolean *end, fmi3Boolean *nominals, fmi3Boolean *values,
      fmi3Boolean *defined, fmi3Float64 *next))
NONE(fmi3GetIntervalDecimal, "a clock", (VARIABLES, fmi3Float64 interval[], fmi3IntervalQualifier qualifier[]))
NONE(fmi3GetIntervalFraction, "a clock",
     (VARIABLES, fmi3UInt64 counter[], fmi3UInt64 resolution[], fmi3IntervalQualifier qualifier[]))
NONE(fmi3GetShiftDecimal, "a clock", (VARIABLES, fmi3Float64 times[]))
NONE(fmi3SetShiftDecimal, "a clock", (VARIABLES, const fmi3Float64 times[]))
NONE(fmi3SetIntervalDecimal, "a clock", (VARIABLES, const fmi3Float64 times[]))
NONE(fmi3GetShiftFraction, "a clock", (VARIABLES, fmi3UInt64 counter[], fmi3UInt64 resolution[]))
NONE(fmi3SetShiftFraction, "a clock", (VARIABLES, const fmi3UInt64 counter[], const fmi3UInt64 resolution[]))
NONE(fmi3SetIntervalFraction, "a clock", (VARIABLES, const fmi3UInt64 counter[], const fmi3UInt64 resolution[]))
NONE(fmi3GetOutputDerivatives, "a derivative of an output",
     (VARIABLES, const fmi3Int32 order[], fmi3Float64 value[], size_t count))

/* What is of model exchange and of scheduled execution. */
NONE(fmi3EnterContinuousTimeMode, "model exchange", (fmi3Instance it))
NONE(fmi3CompletedIntegratorStep, "model exchange",
     (fmi3Instance it, fmi3Boolean never_back, fmi3Boolean *event, fmi3Boolean *end))
NONE(fmi3SetTime, "model exchange", (fmi3Instance it, fmi3Float64 time))
NONE(fmi3SetContinuousStates, "model exchange", (fmi3Instance it, const fmi3Float64 state[], size_t count))
NONE(fmi3GetContinuousStateDerivatives, "model exchange", (fmi3Instance it, fmi3Float64 rate[], size_t count))
NONE(fmi3GetEventIndicators, "model exchange", (fmi3Instance it, fmi3Float64 indicator[], size_t count))
NONE(fmi3GetContinuousStates, "model exchange", (fmi3Instance it, fmi3Float64 state[], size_t count))
NONE(fmi3GetNominalsOfContinuousStates, "model exchange", (fmi3Instance it, fmi3Float64 nominal[], size_t count))
NONE(fmi3GetNumberOfEventIndicators, "model exchange", (fmi3Instance it, size_t *count))
NONE(fmi3GetNumberOfContinuousStates, "model exchange", (fmi3Instance it, size_t *count))
NONE(fmi3ActivateModelPartition, "scheduled execution", (fmi3Instance it, fmi3ValueReference clock, fmi3Float64 time))
