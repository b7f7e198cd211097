/* Functions of the header under names that Rust can call, after the compiler that makes them. */
#include "arm6.h"

#define JOIN_2(a, b) a##_##b
#define JOIN(a, b) JOIN_2(a, b)
#define C(name) JOIN(BUILD, name)

static arm6 arm;

void C(new)(void)
{
    const arm6_parameters params = arm6_default_parameters();
    arm = arm6_new(&params);
}

void C(inverse_dynamics)(const double *q, const double *qd, const double *qdd, double *result)
{
    arm6_inverse_dynamics(&arm, q, qd, qdd, result);
}

void C(mass_matrix)(const double *q, double *result) { arm6_mass_matrix(&arm, q, result); }

void C(forward_dynamics)(const double *q, const double *qd, const double *u, double *result)
{
    arm6_forward_dynamics(&arm, q, qd, u, result);
}
