/* Functions of the header under names that Rust can call. */
#include "arm6.h"

static arm6 arm;

void c_new(void)
{
    const arm6_parameters params = arm6_default_parameters();
    arm = arm6_new(&params);
}

void c_inverse_dynamics(const double *q, const double *qd, const double *qdd, double *result)
{
    arm6_inverse_dynamics(&arm, q, qd, qdd, result);
}

void c_mass_matrix(const double *q, double *result) { arm6_mass_matrix(&arm, q, result); }

void c_forward_dynamics(const double *q, const double *qd, const double *u, double *result)
{
    arm6_forward_dynamics(&arm, q, qd, u, result);
}
