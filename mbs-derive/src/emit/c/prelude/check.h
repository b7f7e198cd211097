#ifndef MBS_CHECK
#define MBS_CHECK
/* What does not hold of a parameter, as NAME_check returns it; 0 where everything holds. */
enum {
    MBS_FINITE = 1,
    MBS_NOT_ZERO,
    MBS_NOT_NEGATIVE,
    MBS_POSITIVE,
    MBS_SEMI_DEFINITE,    /* a principal moment is negative, by more than a thousandth of the greatest */
    MBS_INERTIA_OF_A_BODY /* or greater than the sum of the other two */
};

MBS_FN int mbs_refused(
    int condition, MBS_TEXT const char *name, mbs_real number, MBS_TEXT const char **quantity, mbs_real *value)
{
    *quantity = name;
    *value = number;
    return condition;
}

/* Whether a number satisfies a condition; NaN satisfies none. */
MBS_FN int mbs_require(
    int condition, MBS_TEXT const char *name, mbs_real number, MBS_TEXT const char **quantity, mbs_real *value)
{
    const mbs_real zero = MBS_C(0.0);
    if (!mbs_is_finite(number)) {
        return mbs_refused(MBS_FINITE, name, number, quantity, value);
    }
    if ((condition == MBS_NOT_ZERO && number == zero) || (condition == MBS_NOT_NEGATIVE && number < zero) ||
        (condition == MBS_POSITIVE && number <= zero)) {
        return mbs_refused(condition, name, number, quantity, value);
    }
    return 0;
}
#endif /* MBS_CHECK */

