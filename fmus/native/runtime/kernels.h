/* The component's kernels as machine code. Each writes into what its last pointers point to; the first two
   arguments are numba's: room for a returned number, and for an exception, which kernels never raise.
   The same signatures as in entries.py. */
#ifndef KERNELS_H
#define KERNELS_H

#include <stdint.h>

#define KERNEL(name, ...) int32_t kernel_##name(void *result, void **exception, __VA_ARGS__)

KERNEL(step, double t, double h, double *x, const double *U, const double *p, const double *scale, double *work,
       double *u, double *y);
KERNEL(output, double t, const double *x, const double *u, const double *p, double *y);
KERNEL(derivative, double t, const double *x, const double *u, const double *p, double *dx);
KERNEL(energy, double t, const double *x, const double *u, const double *p, double *e);
KERNEL(slopes, const double *U, double s, double *du);
KERNEL(rates, double t, const double *x, const double *u, const double *du, const double *p, double *work,
       double *yd);
KERNEL(guards, double t, const double *x, const double *u, const double *p, double *g);
KERNEL(transition, int64_t k, double t, double *x, const double *u, const double *p);

/* One of the component's requirements (models/requirements.py); the result is whether it is met. */
#define REQUIREMENT(name) KERNEL(name, const double *x, const double *u, const double *p, double *numbers)

/* Their directional derivatives: after each argument the one of its change, after the result its change. */
#define TANGENT(name)                                                                                          \
    int32_t tangent_##name(void *result, void **exception, double t, double dt, const double *x,               \
                           const double *dx, const double *u, const double *du, const double *p,               \
                           const double *dp, double *value, double *change)

TANGENT(output);
TANGENT(derivative);
TANGENT(energy);
TANGENT(guards);
int32_t tangent_rates(void *result, void **exception, double t, double dt, const double *x, const double *dx,
                      const double *u, const double *du, const double *slope, const double *dslope, const double *p,
                      const double *dp, double *work, double *dwork, double *value, double *change);

#endif
