/* fmi2.h: of FMI 2.0 (fmi-standard.org) what a model for co-simulation exports, in our own words. */
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>

#ifdef __cplusplus
#define FMI2_LINKAGE extern "C"
#else
#define FMI2_LINKAGE
#endif
#if defined(_WIN32)
#define FMI2_EXPORT FMI2_LINKAGE __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_EXPORT FMI2_LINKAGE __attribute__((visibility("default")))
#else
#define FMI2_EXPORT FMI2_LINKAGE
#endif

/* Names begin with FMI2_FUNCTION_PREFIX where several models are linked into one program. */
#ifdef FMI2_FUNCTION_PREFIX
#define FMI2_JOINED(prefix, name) prefix##name
#define FMI2_NAMED(prefix, name) FMI2_JOINED(prefix, name)
#define FMI2(name) FMI2_NAMED(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI2(name) name
#endif

/* A function of the standard, declared as it is exported; what it does follows. */
#define FMI2_FUNCTION(type, name, parameters) \
    FMI2_EXPORT type FMI2(name) parameters; \
    type FMI2(name) parameters

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#endif
