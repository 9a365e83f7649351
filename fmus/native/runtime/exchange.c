/* Model exchange: the host integrates, and stops at events. */
#include <math.h>

#include "kernels.h"
#include "instance.h"

/* A host stops near an event, on either side. One that is due within this time, relative to 1 s or to the time
   itself, is performed: as late or early as steps may begin. */
#define EVENT_SLACK 1e-9
/* As in the steps of co-simulation. */
#define MOST_EVENTS 100

void instance_get_states(const Instance *instance, double *x)
{
    for (int i = 0; i < CONTINUOUS_STATES; i++) x[i] = instance->now.data[X_AT + continuous[i]];
}

Status instance_set_states(Instance *instance, const double *x)
{
    for (int i = 0; i < CONTINUOUS_STATES; i++)
        if (!isfinite(x[i]))
            return instance_say(instance, DISCARD, "%s = %g: must be finite",
                                instance_name(&variables[X_AT + continuous[i]]), x[i]);
    for (int i = 0; i < CONTINUOUS_STATES; i++) instance->now.data[X_AT + continuous[i]] = x[i];
    instance->now.outputs_stale = true;
    return OK;
}

Status instance_derivatives(Instance *instance, double *dx)
{
    instance_all_derivatives(instance, instance->dx);
    for (int i = 0; i < CONTINUOUS_STATES; i++) dx[i] = instance->dx[continuous[i]];
    for (int i = 0; i < CONTINUOUS_STATES; i++)
        if (!isfinite(dx[i])) return instance_undefined(instance, DX_AT + (uint32_t)continuous[i], dx[i]);
    return OK;
}

#if GUARDS

/* The guard that has fallen, or falls within the slack; -1 without one. */
static int due(Instance *instance)
{
    const double *data = instance->now.data, still[PARAMETERS + 1] = {0};
    double dx[STATES + 1], du[INPUTS + 1], g[GUARDS], dg[GUARDS];
    double slack = EVENT_SLACK * (1.0 + fabs(data[T_AT]));
    instance_all_derivatives(instance, dx);
    kernel_slopes(&(int64_t){0}, &(void *){NULL}, data + INPUTS_AT, data[S_AT], du);
    tangent_guards(&(int64_t){0}, &(void *){NULL}, data[T_AT], 1.0, data + X_AT, dx, data + U_AT, du, data, still, g,
                   dg);
    for (int k = 0; k < GUARDS; k++)
        if (g[k] < 0.0 || g[k] + slack * dg[k] < 0.0) return k;
    return -1;
}

bool instance_event_is_due(Instance *instance)
{
    return due(instance) >= 0;
}

static Status perform(Instance *instance, bool *changed)
{
    double *data = instance->now.data;
    for (int count = 0, k; (k = due(instance)) >= 0; count++) {
        if (count == MOST_EVENTS)
            return instance_say(instance, ERROR, "more than %d events at t = %.12g s", MOST_EVENTS, data[T_AT]);
        kernel_transition(&(int64_t){0}, &(void *){NULL}, k, data[T_AT], data + X_AT, data + U_AT, data);
        instance->now.outputs_stale = *changed = true;
    }
    return OK;
}

#else

bool instance_event_is_due(Instance *instance)
{
    (void)instance;
    return false;
}

static Status perform(Instance *instance, bool *changed)
{
    (void)instance; (void)changed;
    return OK;
}

#endif

Status instance_events(Instance *instance, bool *changed, double *next)
{
    const State before = instance->now;
    Status status;
    *changed = false;
    *next = INFINITY;
    if (instance_refuses_parameters(instance, ERROR)) return ERROR;
    status = perform(instance, changed);
    if (status != OK) {
        instance->now = before;
        *changed = false;
    }
    instance_ready(instance, OUTPUTS_AT);
#ifdef NEXT_EVENT_AT
    if (instance->now.data[NEXT_EVENT_AT] < NO_EVENT) *next = instance->now.data[NEXT_EVENT_AT];
#endif
    return status;
}
