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
#define MBS_FN static inline
#define MBS_TEXT __constant
typedef long mbs_long;

