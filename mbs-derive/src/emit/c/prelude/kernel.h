#ifndef MBS_KERNEL
#ifdef MBS_OPENCL
#define MBS_KERNEL __kernel void
#define MBS_GLOBAL __global
#define MBS_STATE get_global_id(0)
#else
#define MBS_KERNEL extern "C" __global__ void
#define MBS_GLOBAL
#define MBS_STATE ((size_t)blockIdx.x * blockDim.x + threadIdx.x)
#endif
#endif /* MBS_KERNEL */

#ifndef MBS_GATHER
#define MBS_GATHER
/* The numbers of one state out of arrays of all states' numbers, and back. */
MBS_FN void mbs_gather(size_t states, size_t state, int count, MBS_GLOBAL const mbs_real *all, mbs_real *own)
{
    for (int k = 0; k < count; k++) {
        own[k] = all[(size_t)k * states + state];
    }
}

MBS_FN void mbs_scatter(size_t states, size_t state, int count, const mbs_real *own, MBS_GLOBAL mbs_real *all)
{
    for (int k = 0; k < count; k++) {
        all[(size_t)k * states + state] = own[k];
    }
}
#endif /* MBS_GATHER */

