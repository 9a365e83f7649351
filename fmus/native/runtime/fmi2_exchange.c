/* FMI 2.0 for model exchange over `instance`. */
#include <math.h>

#include "fmi2.h"

static fmi2Status sized(Instance *instance, size_t count, size_t expected, const void *values)
{
    if (count == expected && (values || !count)) return fmi2OK;
    return instance_say(instance, ERROR, "%zu values: there are %zu, and a place for them must be given", count,
                        expected);
}

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    NEEDS(EVENT | CONTINUOUS, "fmi2EnterEventMode");
    INSTANCE->now.phase = EVENT;
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    bool changed;
    double next;
    Status status;
    NEEDS(EVENT, "fmi2NewDiscreteStates");
    if (!info) return instance_say(INSTANCE, ERROR, "fmi2NewDiscreteStates: no place for what it tells");
    status = instance_events(INSTANCE, &changed, &next);
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
    INSTANCE->now.phase = CONTINUOUS;
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set_state, fmi2Boolean *enter_event_mode,
                                       fmi2Boolean *terminate)
{
    NEEDS(CONTINUOUS, "fmi2CompletedIntegratorStep");
    (void)no_set_state;
    if (!enter_event_mode || !terminate)
        return instance_say(INSTANCE, ERROR, "fmi2CompletedIntegratorStep: no place for what it tells");
    *enter_event_mode = instance_event_is_due(INSTANCE);
    *terminate = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    NEEDS(EVENT | CONTINUOUS, "fmi2SetTime");
    if (!isfinite(time)) return instance_say(INSTANCE, ERROR, "time = %g s: must be finite", time);
    INSTANCE->now.data[T_AT] = time;
    INSTANCE->now.outputs_stale = true;
    return fmi2OK;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t count)
{
    NEEDS(CONTINUOUS | EVENT, "fmi2SetContinuousStates");
    if (sized(INSTANCE, count, CONTINUOUS_STATES, x)) return fmi2Error;
    return instance_set_states(INSTANCE, x);
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t count)
{
    NEEDS(READABLE, "fmi2GetContinuousStates");
    if (sized(INSTANCE, count, CONTINUOUS_STATES, x)) return fmi2Error;
    instance_ready(INSTANCE, OUTPUTS_AT);
    instance_get_states(INSTANCE, x);
    return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x[], size_t count)
{
    NEEDS(ANY, "fmi2GetNominalsOfContinuousStates");
    if (sized(INSTANCE, count, CONTINUOUS_STATES, x)) return fmi2Error;
    for (int i = 0; i < CONTINUOUS_STATES; i++) x[i] = nominal[continuous[i]];
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real dx[], size_t count)
{
    NEEDS(READABLE, "fmi2GetDerivatives");
    if (sized(INSTANCE, count, CONTINUOUS_STATES, dx)) return fmi2Error;
    instance_derivatives(INSTANCE, dx);
    return fmi2OK;
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real g[], size_t count)
{
    NEEDS(READABLE, "fmi2GetEventIndicators");
    if (sized(INSTANCE, count, GUARDS, g)) return fmi2Error;
    instance_indicators(INSTANCE, g);
    return fmi2OK;
}
