/* What FMI 3.0 asks for and no component has: other types, clocks, structural parameters, sizes that change. */
#include "fmi3.h"

/* The calls only say that there is nothing to them. */
#pragma GCC diagnostic ignored "-Wunused-parameter"

static fmi3Status none(fmi3Instance handle, const char *call, int phases, size_t count, const char *what)
{
    NEEDS(phases, call);
    return count ? instance_say(INSTANCE, ERROR, "%s: this FMU has no %s", call, what) : fmi3OK;
}

/* A call about `count` variables of a kind that there is none of, in some phases; its further arguments. */
#define NONE_OF(Call, phases, what, ...)                                                                               \
    fmi3Status Call(fmi3Instance handle, const fmi3ValueReference vr[], size_t count, __VA_ARGS__)                     \
    {                                                                                                                  \
        return none(handle, #Call, phases, count, what);                                                               \
    }

#define NONE_OF_TYPE(Type)                                                                                             \
    NONE_OF(fmi3Get##Type, READABLE, "variables of type " #Type, fmi3##Type values[], size_t size)                     \
    NONE_OF(fmi3Set##Type, SETTABLE, "variables of type " #Type, const fmi3##Type values[], size_t size)

NONE_OF_TYPE(Float32)
NONE_OF_TYPE(Int8)
NONE_OF_TYPE(UInt8)
NONE_OF_TYPE(Int16)
NONE_OF_TYPE(UInt16)
NONE_OF_TYPE(UInt32)
NONE_OF_TYPE(UInt64)
NONE_OF_TYPE(String)
NONE_OF(fmi3GetBinary, READABLE, "variables of type Binary", size_t sizes[], fmi3Binary values[], size_t size)
NONE_OF(fmi3SetBinary, SETTABLE, "variables of type Binary", const size_t sizes[], const fmi3Binary values[],
        size_t size)

NONE_OF(fmi3GetClock, ANY, "clocks", fmi3Clock values[])
NONE_OF(fmi3SetClock, ANY, "clocks", const fmi3Clock values[])
NONE_OF(fmi3GetIntervalDecimal, ANY, "clocks", fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
NONE_OF(fmi3GetIntervalFraction, ANY, "clocks", fmi3UInt64 counters[], fmi3UInt64 resolutions[],
        fmi3IntervalQualifier qualifiers[])
NONE_OF(fmi3GetShiftDecimal, ANY, "clocks", fmi3Float64 shifts[])
NONE_OF(fmi3GetShiftFraction, ANY, "clocks", fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NONE_OF(fmi3SetIntervalDecimal, ANY, "clocks", const fmi3Float64 intervals[])
NONE_OF(fmi3SetIntervalFraction, ANY, "clocks", const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NONE_OF(fmi3SetShiftDecimal, ANY, "clocks", const fmi3Float64 shifts[])
NONE_OF(fmi3SetShiftFraction, ANY, "clocks", const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])

/* A call with these arguments that needs what there is not. */
#define NEVER(Call, what, ...)                                                                                         \
    fmi3Status Call(__VA_ARGS__)                                                                                       \
    {                                                                                                                  \
        return none(handle, #Call, ANY, 1, what);                                                                      \
    }
#define STATED_ONLY "dependencies but those in modelDescription.xml"

NEVER(fmi3ActivateModelPartition, "clocks", fmi3Instance handle, fmi3ValueReference clock, fmi3Float64 time)
NEVER(fmi3EnterConfigurationMode, "structural parameters", fmi3Instance handle)
NEVER(fmi3ExitConfigurationMode, "structural parameters", fmi3Instance handle)
NEVER(fmi3EvaluateDiscreteStates, "other equations at events than fmi3UpdateDiscreteStates", fmi3Instance handle)
NEVER(fmi3GetNumberOfVariableDependencies, STATED_ONLY, fmi3Instance handle, fmi3ValueReference vr, size_t *count)
NEVER(fmi3GetVariableDependencies, STATED_ONLY, fmi3Instance handle, fmi3ValueReference dependent, size_t elements[],
      fmi3ValueReference independents[], size_t of[], fmi3DependencyKind kinds_of[], size_t count)
