/* fmi3.h: of FMI 3.0 (fmi-standard.org) what a model for co-simulation exports, in our own words. */
#ifndef FMI3_H
#define FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define FMI3_LINKAGE extern "C"
#else
#define FMI3_LINKAGE
#endif
#if defined(_WIN32)
#define FMI3_EXPORT FMI3_LINKAGE __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI3_EXPORT FMI3_LINKAGE __attribute__((visibility("default")))
#else
#define FMI3_EXPORT FMI3_LINKAGE
#endif

/* Names begin with FMI3_FUNCTION_PREFIX where several models are linked into one program. */
#ifdef FMI3_FUNCTION_PREFIX
#define FMI3_JOINED(prefix, name) prefix##name
#define FMI3_NAMED(prefix, name) FMI3_JOINED(prefix, name)
#define FMI3(name) FMI3_NAMED(FMI3_FUNCTION_PREFIX, name)
#else
#define FMI3(name) name
#endif

/* A function of the standard, declared as it is exported; what it does follows. */
#define FMI3_FUNCTION(type, name, parameters) \
    FMI3_EXPORT type FMI3(name) parameters; \
    type FMI3(name) parameters

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef char fmi3Char;
typedef const fmi3Char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
    fmi3Independent,
    fmi3Constant,
    fmi3Fixed,
    fmi3Tunable,
    fmi3Discrete,
    fmi3Dependent
} fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean, fmi3Boolean,
                                               fmi3Boolean, fmi3Boolean, fmi3Boolean *, fmi3Float64 *);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

/* Values of a type, by their references. */
#define FMI3_GET(type) \
    FMI3_FUNCTION(fmi3Status, fmi3Get##type, (fmi3Instance it, const fmi3ValueReference reference[], \
                                             size_t references, fmi3##type value[], size_t count))
#define FMI3_SET(type) \
    FMI3_FUNCTION(fmi3Status, fmi3Set##type, (fmi3Instance it, const fmi3ValueReference reference[], \
                                             size_t references, const fmi3##type value[], size_t count))

#endif
