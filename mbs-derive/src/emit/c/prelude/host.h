#include <math.h>
#include <stddef.h>

#ifndef MBS_PRELUDE
#define MBS_PRELUDE

#if defined(__CUDACC__) || defined(__HIPCC__)
#define MBS_FN [[maybe_unused]] static inline __host__ __device__
#else
#define MBS_FN static inline
#endif
#define MBS_TEXT
typedef long long mbs_long;

