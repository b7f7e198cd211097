/* Numbers: define MBS_REAL as float before the first header for single precision. */
#ifndef MBS_REAL
#define MBS_REAL double
#endif
typedef MBS_REAL mbs_real;
#define MBS_C(value) ((mbs_real)(value))

/* Whether they are float, and the function of the library for them. */
#define MBS_IS_float 1
#define MBS_IS_double 0
#define MBS_JOIN_2(a, b) a##b
#define MBS_JOIN(a, b) MBS_JOIN_2(a, b)
#if MBS_JOIN(MBS_IS_, MBS_REAL)
#define MBS_LIBRARY_TRIGONOMETRY
#endif
#if MBS_JOIN(MBS_IS_, MBS_REAL) && !defined(MBS_OPENCL)
#define MBS_CALL(name) name##f
#else
#define MBS_CALL(name) name
#endif

/* The distance from 1 to the next number. */
#define MBS_ROUNDING (sizeof(mbs_real) == 4 ? 1.1920928955078125e-7 : 2.220446049250313e-16)

MBS_FN mbs_real mbs_tan(mbs_real x) { return MBS_CALL(tan)(x); }
MBS_FN mbs_real mbs_asin(mbs_real x) { return MBS_CALL(asin)(x); }
MBS_FN mbs_real mbs_acos(mbs_real x) { return MBS_CALL(acos)(x); }
MBS_FN mbs_real mbs_atan(mbs_real x) { return MBS_CALL(atan)(x); }
MBS_FN mbs_real mbs_atan2(mbs_real y, mbs_real x) { return MBS_CALL(atan2)(y, x); }
MBS_FN mbs_real mbs_sinh(mbs_real x) { return MBS_CALL(sinh)(x); }
MBS_FN mbs_real mbs_cosh(mbs_real x) { return MBS_CALL(cosh)(x); }
MBS_FN mbs_real mbs_tanh(mbs_real x) { return MBS_CALL(tanh)(x); }
MBS_FN mbs_real mbs_sech(mbs_real x) { return MBS_C(1.0) / mbs_cosh(x); }
MBS_FN mbs_real mbs_exp(mbs_real x) { return MBS_CALL(exp)(x); }
MBS_FN mbs_real mbs_ln(mbs_real x) { return MBS_CALL(log)(x); }
MBS_FN mbs_real mbs_sqrt(mbs_real x) { return MBS_CALL(sqrt)(x); }
MBS_FN mbs_real mbs_powf(mbs_real x, mbs_real y) { return MBS_CALL(pow)(x, y); }
MBS_FN mbs_real mbs_abs(mbs_real x) { return MBS_CALL(fabs)(x); }
/* -1, 0 or 1; NaN of NaN. */
MBS_FN mbs_real mbs_signum(mbs_real x)
{
    return x > MBS_C(0.0) ? MBS_C(1.0) : x < MBS_C(0.0) ? MBS_C(-1.0) : x * MBS_C(0.0);
}
MBS_FN int mbs_is_finite(mbs_real x) { return mbs_abs(x) < MBS_C(INFINITY); }
MBS_FN mbs_real mbs_larger(mbs_real a, mbs_real b) { return a < b ? b : a; }

