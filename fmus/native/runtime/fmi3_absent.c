/* What FMI 3.0 asks for and no component has: other types, clocks, structural parameters, sizes that change. */
#include "fmi3.h"

#define NONE_OF(Type)                                                                                                  \
    fmi3Status fmi3Get##Type(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, fmi3##Type values[],    \
                             size_t size)                                                                              \
    {                                                                                                                  \
        (void)vr; (void)values; (void)size;                                                                            \
        return none(handle, "fmi3Get" #Type, READABLE, count, "variables of type " #Type);                             \
    }                                                                                                                  \
    fmi3Status fmi3Set##Type(fmi3Instance handle, const fmi3ValueReference vr[], size_t count,                         \
                             const fmi3##Type values[], size_t size)                                                   \
    {                                                                                                                  \
        (void)vr; (void)values; (void)size;                                                                            \
        return none(handle, "fmi3Set" #Type, SETTABLE, count, "variables of type " #Type);                             \
    }

static fmi3Status none(fmi3Instance handle, const char *call, int phases, size_t count, const char *what)
{
    NEEDS(phases, call);
    return count ? instance_say(INSTANCE, ERROR, "%s: this FMU has no %s", call, what) : fmi3OK;
}

NONE_OF(Float32)
NONE_OF(Int8)
NONE_OF(UInt8)
NONE_OF(Int16)
NONE_OF(UInt16)
NONE_OF(UInt32)
NONE_OF(UInt64)
NONE_OF(String)

fmi3Status fmi3GetBinary(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, size_t sizes[],
                         fmi3Binary values[], size_t size)
{
    (void)vr; (void)sizes; (void)values; (void)size;
    return none(handle, "fmi3GetBinary", READABLE, count, "variables of type Binary");
}

fmi3Status fmi3SetBinary(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, const size_t sizes[],
                         const fmi3Binary values[], size_t size)
{
    (void)vr; (void)sizes; (void)values; (void)size;
    return none(handle, "fmi3SetBinary", SETTABLE, count, "variables of type Binary");
}

/* Clocks */

#define CLOCKS(call) none(handle, call, ANY, count, "clocks")

fmi3Status fmi3GetClock(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, fmi3Clock values[])
{
    (void)vr; (void)values;
    return CLOCKS("fmi3GetClock");
}

fmi3Status fmi3SetClock(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, const fmi3Clock values[])
{
    (void)vr; (void)values;
    return CLOCKS("fmi3SetClock");
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance handle, const fmi3ValueReference vr[], size_t count,
                                  fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
{
    (void)vr; (void)intervals; (void)qualifiers;
    return CLOCKS("fmi3GetIntervalDecimal");
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance handle, const fmi3ValueReference vr[], size_t count,
                                   fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
{
    (void)vr; (void)counters; (void)resolutions; (void)qualifiers;
    return CLOCKS("fmi3GetIntervalFraction");
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, fmi3Float64 shifts[])
{
    (void)vr; (void)shifts;
    return CLOCKS("fmi3GetShiftDecimal");
}

fmi3Status fmi3GetShiftFraction(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, fmi3UInt64 counters[],
                                fmi3UInt64 resolutions[])
{
    (void)vr; (void)counters; (void)resolutions;
    return CLOCKS("fmi3GetShiftFraction");
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance handle, const fmi3ValueReference vr[], size_t count,
                                  const fmi3Float64 intervals[])
{
    (void)vr; (void)intervals;
    return CLOCKS("fmi3SetIntervalDecimal");
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance handle, const fmi3ValueReference vr[], size_t count,
                                   const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)vr; (void)counters; (void)resolutions;
    return CLOCKS("fmi3SetIntervalFraction");
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance handle, const fmi3ValueReference vr[], size_t count,
                               const fmi3Float64 shifts[])
{
    (void)vr; (void)shifts;
    return CLOCKS("fmi3SetShiftDecimal");
}

fmi3Status fmi3SetShiftFraction(fmi3Instance handle, const fmi3ValueReference vr[], size_t count,
                                const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void)vr; (void)counters; (void)resolutions;
    return CLOCKS("fmi3SetShiftFraction");
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance handle, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock; (void)time;
    return none(handle, "fmi3ActivateModelPartition", ANY, 1, "clocks");
}

/* Configuration and what capability flags deny */

fmi3Status fmi3EnterConfigurationMode(fmi3Instance handle)
{
    return none(handle, "fmi3EnterConfigurationMode", ANY, 1, "structural parameters");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance handle)
{
    return none(handle, "fmi3ExitConfigurationMode", ANY, 1, "structural parameters");
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance handle)
{
    return none(handle, "fmi3EvaluateDiscreteStates", ANY, 1,
                "other equations at events than fmi3UpdateDiscreteStates");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance handle, fmi3ValueReference vr, size_t *count)
{
    (void)vr; (void)count;
    return none(handle, "fmi3GetNumberOfVariableDependencies", ANY, 1,
                "dependencies but those in modelDescription.xml");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance handle, fmi3ValueReference dependent, size_t elements[],
                                       fmi3ValueReference independents[], size_t of[], fmi3DependencyKind kinds_of[],
                                       size_t count)
{
    (void)dependent; (void)elements; (void)independents; (void)of; (void)kinds_of; (void)count;
    return none(handle, "fmi3GetVariableDependencies", ANY, 1, "dependencies but those in modelDescription.xml");
}
