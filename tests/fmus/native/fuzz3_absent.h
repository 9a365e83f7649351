/* Functions of FMI 3.0 for what no component has. Included once for their list, and with CALL_ABSENT for the calls.
   They refuse in every phase, unless they are asked about no variable at all. */
#ifndef CALL_ABSENT

#define ABSENT(F)                                                                                               \
    F(GetFloat32, GET) F(GetInt8, GET) F(GetUInt8, GET) F(GetInt16, GET) F(GetUInt16, GET) F(GetUInt32, GET)    \
    F(GetUInt64, GET) F(GetString, GET) F(SetFloat32, SET) F(SetInt8, SET) F(SetUInt8, SET) F(SetInt16, SET)    \
    F(SetUInt16, SET) F(SetUInt32, SET) F(SetUInt64, SET) F(SetString, SET)
#define ABSENT_OTHERS(F)                                                                                        \
    F(GetBinary, GET) F(SetBinary, SET) F(GetClock, ANY) F(SetClock, ANY) F(GetIntervalDecimal, ANY)            \
    F(GetIntervalFraction, ANY) F(GetShiftDecimal, ANY) F(GetShiftFraction, ANY) F(SetIntervalDecimal, ANY)     \
    F(SetIntervalFraction, ANY) F(SetShiftDecimal, ANY) F(SetShiftFraction, ANY) F(ActivateModelPartition, 0)   \
    F(EnterConfigurationMode, 0) F(ExitConfigurationMode, 0) F(EvaluateDiscreteStates, 0)                       \
    F(GetNumberOfVariableDependencies, 0) F(GetVariableDependencies, 0)

#else

static fmi3Status of_absent(int f, const char **wrong)
{
    const size_t n = below(3);
    void *v = reals;
    if (n || !allowed[f]) *wrong = "absent";
    switch (f) {
#define CASE(name, phases) case AT_##name: return name(at->unit, vr, n, v, n);
        ABSENT(CASE)
    case AT_GetBinary: return GetBinary(at->unit, vr, n, v, v, n);
    case AT_SetBinary: return SetBinary(at->unit, vr, n, v, v, n);
    case AT_GetClock: return GetClock(at->unit, vr, n, v);
    case AT_SetClock: return SetClock(at->unit, vr, n, v);
    case AT_GetIntervalDecimal: return GetIntervalDecimal(at->unit, vr, n, v, v);
    case AT_GetIntervalFraction: return GetIntervalFraction(at->unit, vr, n, v, v, v);
    case AT_GetShiftDecimal: return GetShiftDecimal(at->unit, vr, n, v);
    case AT_GetShiftFraction: return GetShiftFraction(at->unit, vr, n, v, v);
    case AT_SetIntervalDecimal: return SetIntervalDecimal(at->unit, vr, n, v);
    case AT_SetIntervalFraction: return SetIntervalFraction(at->unit, vr, n, v, v);
    case AT_SetShiftDecimal: return SetShiftDecimal(at->unit, vr, n, v);
    case AT_SetShiftFraction: return SetShiftFraction(at->unit, vr, n, v, v);
    case AT_ActivateModelPartition: return ActivateModelPartition(at->unit, vr[0], wild_real());
    case AT_EnterConfigurationMode: return EnterConfigurationMode(at->unit);
    case AT_ExitConfigurationMode: return ExitConfigurationMode(at->unit);
    case AT_EvaluateDiscreteStates: return EvaluateDiscreteStates(at->unit);
    case AT_GetNumberOfVariableDependencies: return GetNumberOfVariableDependencies(at->unit, vr[0], v);
    default: return GetVariableDependencies(at->unit, vr[0], v, vr, v, v, n);
    }
}

#endif
