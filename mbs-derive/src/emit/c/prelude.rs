//! What all headers of mechanisms share, once in a translation unit.

/// The number type, elementary functions, splines, and `M = L D Lᵀ` in the order of operations of mbs-runtime.
pub(super) const TEXT: &str = r"#include <math.h>
#include <stddef.h>

#ifndef MBS_PRELUDE
#define MBS_PRELUDE

/* Numbers: define MBS_REAL as float before the first header for single precision. */
#ifndef MBS_REAL
#define MBS_REAL double
#endif
typedef MBS_REAL mbs_real;
#define MBS_C(value) ((mbs_real)(value))

static inline mbs_real mbs_sin(mbs_real x) { return (mbs_real)sin(x); }
static inline mbs_real mbs_cos(mbs_real x) { return (mbs_real)cos(x); }
static inline mbs_real mbs_tan(mbs_real x) { return (mbs_real)tan(x); }
static inline mbs_real mbs_asin(mbs_real x) { return (mbs_real)asin(x); }
static inline mbs_real mbs_acos(mbs_real x) { return (mbs_real)acos(x); }
static inline mbs_real mbs_atan(mbs_real x) { return (mbs_real)atan(x); }
static inline mbs_real mbs_atan2(mbs_real y, mbs_real x) { return (mbs_real)atan2(y, x); }
static inline mbs_real mbs_sinh(mbs_real x) { return (mbs_real)sinh(x); }
static inline mbs_real mbs_cosh(mbs_real x) { return (mbs_real)cosh(x); }
static inline mbs_real mbs_tanh(mbs_real x) { return (mbs_real)tanh(x); }
static inline mbs_real mbs_sech(mbs_real x) { return MBS_C(1.0) / mbs_cosh(x); }
static inline mbs_real mbs_exp(mbs_real x) { return (mbs_real)exp(x); }
static inline mbs_real mbs_ln(mbs_real x) { return (mbs_real)log(x); }
static inline mbs_real mbs_sqrt(mbs_real x) { return (mbs_real)sqrt(x); }
static inline mbs_real mbs_powf(mbs_real x, mbs_real y) { return (mbs_real)pow(x, y); }
static inline mbs_real mbs_abs(mbs_real x) { return (mbs_real)fabs(x); }
/* -1, 0 or 1; NaN of NaN. */
static inline mbs_real mbs_signum(mbs_real x)
{
    return x > MBS_C(0.0) ? MBS_C(1.0) : x < MBS_C(0.0) ? MBS_C(-1.0) : x * MBS_C(0.0);
}

/* M = L D L^T in place of the lower triangle of an n by n matrix, and 1/D. No pivoting: M is positive definite. */
static inline void mbs_ldlt(size_t n, mbs_real *m, mbs_real *reciprocals)
{
    for (size_t k = 0; k < n; k++) {
        reciprocals[k] = MBS_C(1.0) / m[k * n + k];
        for (size_t i = k + 1; i < n; i++) {
            const mbs_real u = m[i * n + k];
            for (size_t j = k + 1; j <= i; j++) {
                /* Column k of L has replaced what was above row i. */
                const mbs_real l = j < i ? m[j * n + k] : u * reciprocals[k];
                m[i * n + j] = m[i * n + j] - u * l;
            }
            m[i * n + k] = u * reciprocals[k];
        }
    }
}

/* X of M X = B in place of B, rows of this many columns. */
static inline void mbs_ldlt_solve(size_t n, size_t columns, const mbs_real *m, const mbs_real *reciprocals, mbs_real *b)
{
    for (size_t c = 0; c < columns; c++) {
        for (size_t k = 0; k < n; k++) {
            for (size_t i = k + 1; i < n; i++) {
                b[i * columns + c] = b[i * columns + c] - m[i * n + k] * b[k * columns + c];
            }
        }
        for (size_t i = n; i-- > 0;) {
            mbs_real x = b[i * columns + c] * reciprocals[i];
            for (size_t k = i + 1; k < n; k++) {
                x = x - m[k * n + i] * b[k * columns + c];
            }
            b[i * columns + c] = x;
        }
    }
}

/* A derivative of a piecewise polynomial: a row has its origin, then coefficients from the constant on. */
static inline mbs_real mbs_spline(
    size_t count, const mbs_real *places, size_t numbers, const mbs_real *rows, size_t order, mbs_real x)
{
    const size_t columns = numbers / (count + 1);
    size_t first = 0;
    size_t last = count;
    while (first < last) {
        const size_t middle = first + (last - first) / 2;
        if (x < places[middle]) {
            last = middle;
        } else {
            first = middle + 1;
        }
    }
    const mbs_real *row = rows + first * columns;
    const mbs_real s = x - row[0];
    mbs_real sum = s * MBS_C(0.0);
    for (size_t power = columns - 1; power-- > order;) {
        size_t factor = 1;
        for (size_t k = power + 1 - order; k <= power; k++) {
            factor *= k;
        }
        sum = (mbs_real)factor * row[1 + power] + s * sum;
    }
    return sum;
}
#endif /* MBS_PRELUDE */
";
