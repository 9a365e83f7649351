/* FMI 2.0 over `instance`: model exchange and saved states. */
#include <math.h>

#include "fmi2.h"
#include "common_calls.h"

fmi2Status fmi2EnterEventMode(fmi2Component handle)
{
    NEEDS(EVENT | CONTINUOUS, "fmi2EnterEventMode");
    INSTANCE->now.phase = EVENT;
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component handle, fmi2EventInfo *info)
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
