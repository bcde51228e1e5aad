/* vectors.h: numbers that are computed at once. */
#include "apart.h"

/* Bytes of the widest vectors that the compiler may use; 0 where it knows none, or NAME_PLAIN asks for plain C. Wider ones
 * would go through memory. */
#if !defined(__GNUC__) || defined(__FRAMAC__) || defined(NAME_PLAIN)
#define VECTOR 0
#elif defined(__AVX512F__)
#define VECTOR 64
#elif defined(__AVX__)
#define VECTOR 32
#elif defined(__SSE2__) || defined(__aarch64__) || defined(__VSX__) || defined(__wasm_simd128__)
#define VECTOR 16
#else
#define VECTOR 0
#endif

#if VECTOR > 0
typedef real lanes __attribute__((vector_size(VECTOR)));
typedef real slice __attribute__((vector_size(VECTOR), aligned(sizeof(real)), may_alias)); /* anywhere in an array */
typedef __typeof__(*(const lanes *)0 < *(const lanes *)0) choice; /* of numbers: all their bits, or none */
#else
typedef real lanes;
typedef real slice;
#endif
enum { LANES = sizeof(slice) / sizeof(real) };

/* Of functions whose counts of vectors and outputs are known where they are called. */
#if defined(__clang__) && defined(__AVX512F__) && VECTOR > 0
#define WITHIN static inline __attribute__((always_inline, min_vector_width(512))) /* else it takes halves of vectors */
#elif defined(__GNUC__) && !defined(__FRAMAC__)
#define WITHIN static inline __attribute__((always_inline))
#elif defined(_MSC_VER)
#define WITHIN static __forceinline
#else
#define WITHIN static
#endif

/* Loops over a few vectors are unrolled, so that they stay in registers; not where size counts more than speed. */
#if defined(__OPTIMIZE_SIZE__)
#define UNROLLED
#elif defined(__clang__)
#define UNROLLED _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#define UNROLLED _Pragma("GCC unroll 16")
#else
#define UNROLLED
#endif

/* On aarch64 what is loaded by a number that has been given this way is loaded where it stands. Out of loops compilers would
 * keep more vectors than there are registers, and the rest on the stack; x86-64 has such loads as operands for nothing. */
#if VECTOR > 0 && defined(__aarch64__)
#define LOADED_HERE(number) __asm__ volatile("" : "+r"(number))
#else
#define LOADED_HERE(number)
#endif
