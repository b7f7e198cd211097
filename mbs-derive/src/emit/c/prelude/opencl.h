#ifndef MBS_PRELUDE
#define MBS_PRELUDE

#ifdef cl_khr_fp64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif
/* The bits of the Rust: define MBS_CONTRACT for sums of products with one rounding. */
#ifndef MBS_CONTRACT
#pragma OPENCL FP_CONTRACT OFF
#endif
#define MBS_OPENCL
#define MBS_FN __attribute__((unused)) static inline
#define MBS_TEXT __constant
typedef long mbs_long;


/* The bits of a double. */
typedef ulong mbs_bits;
#define mbs_to_bits(x) as_ulong(x)
#define mbs_from_bits(bits) as_double(bits)
