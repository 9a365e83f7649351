/* Model exchange: the host integrates, and stops at events. */
#include <math.h>

#include "kernels.h"
#include "unit.h"

/* A host stops near an event, on either side. One that is due within this time, relative to 1 s or to the time
   itself, is performed: as late or early as steps may begin. */
#define EVENT_SLACK 1e-9
/* As in the steps of co-simulation. */
#define MOST_EVENTS 100

void unit_get_states(const Unit *unit, double *x)
{
    for (int i = 0; i < CONTINUOUS_STATES; i++) x[i] = unit->now.data[X_AT + continuous[i]];
}

Status unit_set_states(Unit *unit, const double *x)
{
    for (int i = 0; i < CONTINUOUS_STATES; i++)
        if (!isfinite(x[i]))
            return unit_say(unit, DISCARD, "%s = %g: must be finite",
                            unit_name(&variables[X_AT + continuous[i]]), x[i]);
    for (int i = 0; i < CONTINUOUS_STATES; i++) unit->now.data[X_AT + continuous[i]] = x[i];
    unit->now.outputs_stale = true;
    return OK;
}

void unit_all_derivatives(Unit *unit, double *dx)
{
    const double *data = unit->now.data;
    unit_ready(unit, OUTPUTS_AT);
    kernel_derivative(&(int64_t){0}, &(void *){NULL}, data[T_AT], data + X_AT, data + U_AT, data, dx);
}

void unit_derivatives(Unit *unit, double *dx)
{
    unit_all_derivatives(unit, unit->dx);
    for (int i = 0; i < CONTINUOUS_STATES; i++) dx[i] = unit->dx[continuous[i]];
}

#if GUARDS

void unit_indicators(Unit *unit, double *g)
{
    const double *data = unit->now.data;
    unit_ready(unit, OUTPUTS_AT);
    kernel_guards(&(int64_t){0}, &(void *){NULL}, data[T_AT], data + X_AT, data + U_AT, data, g);
}

/* The guard that has fallen, or falls within the slack; -1 without one. */
static int due(Unit *unit)
{
    const double *data = unit->now.data, still[PARAMETERS + 1] = {0};
    double dx[STATES + 1], du[INPUTS + 1], g[GUARDS], dg[GUARDS];
    double slack = EVENT_SLACK * (1.0 + fabs(data[T_AT]));
    unit_all_derivatives(unit, dx);
    kernel_slopes(&(int64_t){0}, &(void *){NULL}, data + INPUTS_AT, data[S_AT], du);
    tangent_guards(&(int64_t){0}, &(void *){NULL}, data[T_AT], 1.0, data + X_AT, dx, data + U_AT, du, data, still, g,
                   dg);
    for (int k = 0; k < GUARDS; k++)
        if (g[k] < 0.0 || g[k] + slack * dg[k] < 0.0) return k;
    return -1;
}

bool unit_event_is_due(Unit *unit)
{
    return due(unit) >= 0;
}

static Status perform(Unit *unit, bool *changed)
{
    double *data = unit->now.data;
    for (int count = 0, k; (k = due(unit)) >= 0; count++) {
        if (count == MOST_EVENTS)
            return unit_say(unit, ERROR, "more than %d events at t = %.12g s", MOST_EVENTS, data[T_AT]);
        kernel_transition(&(int64_t){0}, &(void *){NULL}, k, data[T_AT], data + X_AT, data + U_AT, data);
        unit->now.outputs_stale = *changed = true;
    }
    return OK;
}

#else

void unit_indicators(Unit *unit, double *g)
{
    (void)unit, (void)g;
}

bool unit_event_is_due(Unit *unit)
{
    (void)unit;
    return false;
}

static Status perform(Unit *unit, bool *changed)
{
    (void)unit, (void)changed;
    return OK;
}

#endif

Status unit_events(Unit *unit, bool *changed, double *next)
{
    const State before = unit->now;
    Status status;
    *changed = false;
    *next = INFINITY;
    if (unit_refuses_parameters(unit, ERROR)) return ERROR;
    status = perform(unit, changed);
    if (status != OK) {
        unit->now = before;
        *changed = false;
    }
    unit_ready(unit, OUTPUTS_AT);
#ifdef NEXT_EVENT_AT
    if (unit->now.data[NEXT_EVENT_AT] < NO_EVENT) *next = unit->now.data[NEXT_EVENT_AT];
#endif
    return status;
}
