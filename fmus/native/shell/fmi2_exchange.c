/* FMI 2.0 for model exchange over `unit`. */
#include <math.h>

#include "fmi2.h"

static fmi2Status sized(Unit *unit, size_t count, size_t expected, const void *values)
{
    if (count == expected && (values || !count)) return fmi2OK;
    return unit_say(unit, ERROR, "%zu values: there are %zu, and a place for them must be given", count, expected);
}

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    NEEDS(EVENT | CONTINUOUS, "fmi2EnterEventMode");
    UNIT->now.phase = EVENT;
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    bool changed;
    double next;
    Status status;
    NEEDS(EVENT, "fmi2NewDiscreteStates");
    if (!info) return unit_say(UNIT, ERROR, "fmi2NewDiscreteStates: no place for what it tells");
    status = unit_events(UNIT, &changed, &next);
    info->newDiscreteStatesNeeded = info->terminateSimulation = fmi2False;
    info->nominalsOfContinuousStatesChanged = fmi2False;
    info->valuesOfContinuousStatesChanged = changed;
    info->nextEventTimeDefined = isfinite(next);
    info->nextEventTime = isfinite(next) ? next : 0.0;
    return status;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    NEEDS(EVENT, "fmi2EnterContinuousTimeMode");
    UNIT->now.phase = CONTINUOUS;
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set_state, fmi2Boolean *enter_event_mode,
                                       fmi2Boolean *terminate)
{
    NEEDS(CONTINUOUS, "fmi2CompletedIntegratorStep");
    (void)no_set_state;
    if (!enter_event_mode || !terminate)
        return unit_say(UNIT, ERROR, "fmi2CompletedIntegratorStep: no place for what it tells");
    *enter_event_mode = unit_event_is_due(UNIT);
    *terminate = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    NEEDS(EVENT | CONTINUOUS, "fmi2SetTime");
    if (!isfinite(time)) return unit_say(UNIT, ERROR, "time = %g s: must be finite", time);
    UNIT->now.data[T_AT] = time;
    UNIT->now.outputs_stale = true;
    return fmi2OK;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t count)
{
    NEEDS(CONTINUOUS | EVENT, "fmi2SetContinuousStates");
    if (sized(UNIT, count, CONTINUOUS_STATES, x)) return fmi2Error;
    return unit_set_states(UNIT, x);
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t count)
{
    NEEDS(READABLE, "fmi2GetContinuousStates");
    if (sized(UNIT, count, CONTINUOUS_STATES, x)) return fmi2Error;
    unit_ready(UNIT, OUTPUTS_AT);
    unit_get_states(UNIT, x);
    return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x[], size_t count)
{
    NEEDS(ANY, "fmi2GetNominalsOfContinuousStates");
    if (sized(UNIT, count, CONTINUOUS_STATES, x)) return fmi2Error;
    for (int i = 0; i < CONTINUOUS_STATES; i++) x[i] = nominal[continuous[i]];
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real dx[], size_t count)
{
    NEEDS(READABLE, "fmi2GetDerivatives");
    if (sized(UNIT, count, CONTINUOUS_STATES, dx)) return fmi2Error;
    unit_derivatives(UNIT, dx);
    return fmi2OK;
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real g[], size_t count)
{
    NEEDS(READABLE, "fmi2GetEventIndicators");
    if (sized(UNIT, count, GUARDS, g)) return fmi2Error;
    unit_indicators(UNIT, g);
    return fmi2OK;
}
