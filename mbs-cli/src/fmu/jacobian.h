/* Derivatives by direction. */

static int is_unknown(unsigned vr) { return (vr >= VR_Q && vr < VR_U) || (vr >= VR_Y && vr < VR_ENERGY); }

/* Outputs are not differentiated by parameters, nothing by signals: the header has no functions that do. */
static int is_differentiable(unsigned unknown, unsigned known)
{
    if (known >= VR_P && known < VR_Y) return unknown < VR_U;
    return (known >= VR_Q && known < VR_DER_Q) || (known >= VR_U && known < VR_S);
}

/* The derivative of one variable by another. */
static double fmu_slope(const fmu_instance *a, unsigned unknown, unsigned known)
{
    if (unknown < VR_DER_Q) return unknown == known ? 1.0 : 0.0;
    if (unknown < VR_DER_QD) return unknown - VR_DER_Q == known - VR_QD ? 1.0 : 0.0;
    const int is_output = unknown >= VR_Y;
    const size_t row = is_output ? unknown - VR_Y : unknown - VR_DER_QD;
    if (known < VR_QD) return (is_output ? a->y_by_q : a->by_q)[row * N + (known - VR_Q)];
    if (known < VR_DER_Q) return (is_output ? a->y_by_qd : a->by_qd)[row * N + (known - VR_QD)];
    if (known < VR_S) return (is_output ? a->y_by_u : a->by_u)[row * M + (known - VR_U)];
    return a->by_p[row * P + (known - VR_P)];
}

/* The product of the Jacobian, or of its transpose, with a seed. */
static int jacobian_product(
    fmu_instance *a, const char *function, int transposed, const unsigned *unknowns, size_t rows,
    const unsigned *knowns, size_t columns, const double *seed, double *result)
{
    if ((rows > 0 && unknowns == NULL) || (columns > 0 && knowns == NULL) || seed == NULL || result == NULL) {
        return fmu_refuse(a, FAILED, "%s: a null pointer", function);
    }
    if (unknown_reference(a, function, unknowns, rows) || unknown_reference(a, function, knowns, columns))
        return FAILED;
    if (!all_finite(seed, (int)(transposed ? rows : columns)))
        return fmu_refuse(a, FAILED, "%s: a seed is not finite", function);
    for (size_t i = 0; i < rows; i++) {
        if (!is_unknown(unknowns[i]))
            return fmu_refuse(
                a, FAILED, "%s: variable %u, %s, is no unknown", function, unknowns[i], fmu_kind(unknowns[i]));
        for (size_t j = 0; j < columns; j++) {
            if (!is_differentiable(unknowns[i], knowns[j])) {
                return fmu_refuse(
                    a, FAILED, "%s: there is no derivative of %s by %s (variables %u, %u)", function,
                    fmu_kind(unknowns[i]), fmu_kind(knowns[j]), unknowns[i], knowns[j]);
            }
        }
    }
    fmu_complete(a, HAS_SLOPES);
    for (size_t i = 0; i < (transposed ? columns : rows); i++) result[i] = 0.0;
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            const double entry = fmu_slope(a, unknowns[i], knowns[j]);
            if (transposed) {
                result[j] += entry * seed[i];
            } else {
                result[i] += entry * seed[j];
            }
        }
    }
    if (!all_finite(result, (int)(transposed ? columns : rows)))
        return fmu_refuse(a, DISCARDED, "%s: a derivative is not finite at this state", function);
    return GOOD;
}
