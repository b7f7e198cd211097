#include <math.h>
#include <stddef.h>
#include <string.h>

#ifndef MBS_PRELUDE
#define MBS_PRELUDE

#if defined(__CUDACC__) || defined(__HIPCC__)
#define MBS_FN [[maybe_unused]] static inline __host__ __device__
#else
#define MBS_FN static inline
#endif
#define MBS_TEXT
typedef long long mbs_long;


/* The bits of a double. */
typedef unsigned long long mbs_bits;
MBS_FN mbs_bits mbs_to_bits(double x)
{
    mbs_bits bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
MBS_FN double mbs_from_bits(mbs_bits bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}
