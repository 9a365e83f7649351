/* The calls that FMI 2.0 and FMI 3.0 have in common but for their names, in the version whose header is included
   before: fmi2.h or fmi3.h, which say what the macros stand for. */

#define STRING_(name) #name
#define STRING(name) STRING_(name)
#define NAME(name) STRING(FMI(name))

/* Life */

STATUS FMI(SetDebugLogging)(HANDLE handle, FMI(Boolean) on, size_t count, const FMI(String) categories[])
{
    if (!handle) return FMI(Error);
    (void)count; (void)categories; /* all of them */
    INSTANCE->logging = on;
    return FMI(OK);
}

STATUS FMI(Terminate)(HANDLE handle)
{
    NEEDS(MOVING, NAME(Terminate));
    INSTANCE->now.phase = TERMINATED;
    return FMI(OK);
}

STATUS FMI(Reset)(HANDLE handle)
{
    NEEDS(ANY, NAME(Reset));
    instance_reset(INSTANCE);
    return FMI(OK);
}

/* Model exchange */

static STATUS check_size(const Instance *instance, size_t count, size_t expected, const void *values)
{
    if (count == expected && (values || !count)) return FMI(OK);
    return instance_say(instance, ERROR, "%zu values: there are %zu, and a place for them must be given", count,
                        expected);
}

STATUS FMI(EnterContinuousTimeMode)(HANDLE handle)
{
    NEEDS_EXCHANGE(EVENT, NAME(EnterContinuousTimeMode));
    INSTANCE->now.phase = CONTINUOUS;
    return FMI(OK);
}

STATUS FMI(CompletedIntegratorStep)(HANDLE handle, FMI(Boolean) no_set_state, FMI(Boolean) *enter_event_mode,
                                    FMI(Boolean) *terminate)
{
    NEEDS_EXCHANGE(CONTINUOUS, NAME(CompletedIntegratorStep));
    (void)no_set_state;
    if (!enter_event_mode || !terminate)
        return instance_say(INSTANCE, ERROR, "%s: no place for what it tells", NAME(CompletedIntegratorStep));
    *enter_event_mode = instance_event_is_due(INSTANCE);
    *terminate = FMI(False);
    return FMI(OK);
}

STATUS FMI(SetTime)(HANDLE handle, double time)
{
    NEEDS_EXCHANGE(EVENT | CONTINUOUS, NAME(SetTime));
    if (!isfinite(time)) return instance_say(INSTANCE, ERROR, "time = %g s: must be finite", time);
    INSTANCE->now.data[T_AT] = time;
    INSTANCE->now.outputs_stale = true;
    return FMI(OK);
}

STATUS FMI(SetContinuousStates)(HANDLE handle, const double x[], size_t count)
{
    NEEDS_EXCHANGE(EVENT | CONTINUOUS, NAME(SetContinuousStates));
    if (check_size(INSTANCE, count, CONTINUOUS_STATES, x)) return FMI(Error);
    return instance_set_states(INSTANCE, x);
}

STATUS FMI(GetContinuousStates)(HANDLE handle, double x[], size_t count)
{
    NEEDS_EXCHANGE(DIFFERENTIABLE, NAME(GetContinuousStates));
    if (check_size(INSTANCE, count, CONTINUOUS_STATES, x)) return FMI(Error);
    instance_ready(INSTANCE, OUTPUTS_AT);
    instance_get_states(INSTANCE, x);
    return FMI(OK);
}

STATUS FMI(GetNominalsOfContinuousStates)(HANDLE handle, double x[], size_t count)
{
    NEEDS_EXCHANGE(ANY, NAME(GetNominalsOfContinuousStates));
    if (check_size(INSTANCE, count, CONTINUOUS_STATES, x)) return FMI(Error);
    for (int i = 0; i < CONTINUOUS_STATES; i++) x[i] = nominal[continuous[i]];
    return FMI(OK);
}

STATUS FMI(DERIVATIVES)(HANDLE handle, double dx[], size_t count)
{
    NEEDS_EXCHANGE(DIFFERENTIABLE, NAME(DERIVATIVES));
    if (check_size(INSTANCE, count, CONTINUOUS_STATES, dx)) return FMI(Error);
    return instance_derivatives(INSTANCE, dx);
}

STATUS FMI(GetEventIndicators)(HANDLE handle, double g[], size_t count)
{
    NEEDS_EXCHANGE(DIFFERENTIABLE, NAME(GetEventIndicators));
    if (check_size(INSTANCE, count, GUARDS, g)) return FMI(Error);
    instance_indicators(INSTANCE, g);
    for (int i = 0; i < GUARDS; i++)
        if (!isfinite(g[i])) return instance_undefined(INSTANCE, GUARDS_AT + (uint32_t)i, g[i]);
    return FMI(OK);
}

/* Saved states */

STATUS FMI(GET_STATE)(HANDLE handle, FMI(STATE) *state)
{
    NEEDS(ANY, NAME(GET_STATE));
    return instance_keep(INSTANCE, state);
}

STATUS FMI(SET_STATE)(HANDLE handle, FMI(STATE) state)
{
    NEEDS(ANY, NAME(SET_STATE));
    return instance_put_back(INSTANCE, state);
}

STATUS FMI(FREE_STATE)(HANDLE handle, FMI(STATE) *state)
{
    NEEDS(ANY, NAME(FREE_STATE));
    return instance_forget(state);
}

STATUS FMI(STATE_SIZE)(HANDLE handle, FMI(STATE) state, size_t *size)
{
    NEEDS(ANY, NAME(STATE_SIZE));
    return instance_kept_size(INSTANCE, state, size);
}

STATUS FMI(SERIALIZE_STATE)(HANDLE handle, FMI(STATE) state, FMI(Byte) bytes[], size_t size)
{
    NEEDS(ANY, NAME(SERIALIZE_STATE));
    return instance_kept_to_bytes(INSTANCE, state, bytes, size);
}

STATUS FMI(DESERIALIZE_STATE)(HANDLE handle, const FMI(Byte) bytes[], size_t size, FMI(STATE) *state)
{
    NEEDS(ANY, NAME(DESERIALIZE_STATE));
    return instance_kept_from_bytes(INSTANCE, bytes, size, state);
}
