/* real.h: the numbers of a program. */

#if (defined(__FAST_MATH__) || defined(_M_FP_FAST) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || \
     defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)) && \
    !defined(NAME_ALLOW_FAST_MATH)
#error "-ffast-math: bounds of errors no longer hold, nor NaN out of range (-D NAME_ALLOW_FAST_MATH takes it all the same)"
#endif
#if defined(__FLT_EVAL_METHOD__) && (__FLT_EVAL_METHOD__ == 2 || __FLT_EVAL_METHOD__ < 0) && \
    !defined(NAME_ALLOW_FAST_MATH)
#error "x87: bounds of errors no longer hold (-msse2 -mfpmath=sse helps; -D NAME_ALLOW_FAST_MATH takes it all the same)"
#endif

typedef name_real real;

/* Without <math.h>, which not every machine has. */
static real not_a_number(void)
{
    const volatile real zero = 0;
    return zero / zero;
}
