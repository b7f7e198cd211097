
/* Several angles at once: the same bits. */
#ifndef MBS_LOCKSTEP
#define MBS_LOCKSTEP
#ifndef MBS_LIBRARY_TRIGONOMETRY
/* So many in lockstep, by loops that compilers turn into vector instructions, over memory that nothing else reads. */
#define MBS_BLOCK(n) \
    MBS_FN void mbs_sin_cos_##n(const mbs_real *angles, mbs_real *sines, mbs_real *cosines) \
    { \
        mbs_real x[n], s[n], c[n]; \
        int are_near = 1; \
        for (int i = 0; i < (n); i++) { \
            x[i] = angles[i]; \
        } \
        for (int i = 0; i < (n); i++) { \
            mbs_sin_cos_near(x[i], s + i, c + i); \
        } \
        for (int i = 0; i < (n); i++) { \
            are_near &= mbs_abs(x[i]) <= MBS_REACH; \
        } \
        for (int i = 0; i < (n); i++) { \
            sines[i] = s[i]; \
            cosines[i] = c[i]; \
        } \
        for (int i = 0; !are_near && i < (n); i++) { \
            mbs_sin_cos(x[i], sines + i, cosines + i); \
        } \
    }
MBS_BLOCK(8)
MBS_BLOCK(4)
MBS_BLOCK(2)
#endif

MBS_FN void mbs_sin_cos_all(int count, const mbs_real *angles, mbs_real *sines, mbs_real *cosines)
{
    int i = 0;
#ifndef MBS_LIBRARY_TRIGONOMETRY
    for (; count - i >= 8; i += 8) {
        mbs_sin_cos_8(angles + i, sines + i, cosines + i);
    }
    if (count - i >= 4) {
        mbs_sin_cos_4(angles + i, sines + i, cosines + i);
        i += 4;
    }
    if (count - i >= 2) {
        mbs_sin_cos_2(angles + i, sines + i, cosines + i);
        i += 2;
    }
#endif
    for (; i < count; i++) {
        mbs_sin_cos(angles[i], sines + i, cosines + i);
    }
}
#endif /* MBS_LOCKSTEP */
