/* apart.h: functions that no compiler puts into others. */

/* On aarch64 functions that are called in loops are by themselves, where they have vectors. Put into a loop that calls others,
 * too, they would have their constants taken out of it, and on the stack: a call there keeps 8 bytes of a register at most. */
#if defined(__GNUC__) && defined(__aarch64__)
#define BY_ITSELF __attribute__((noinline))
#else
#define BY_ITSELF
#endif
