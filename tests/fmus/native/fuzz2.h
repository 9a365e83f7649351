/* Calls of fuzz.c that are of FMI 2.0 alone. */
#define INSTANTIATE(F) F(Instantiate, 0)
#define UPDATE AT_NewDiscreteStates
#define RESUME AT_EnterContinuousTimeMode

static const fmi2String strings[MOST];
static fmi2InstantiateTYPE *Instantiate;

static void logger(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    if (environment != &places) fail("a logger with another environment");
    listen(status, instance, category, message);
    for (const char *c = message; *c; c++) /* hosts hand it to printf */
        if (*c == '%' && *++c != '%') fail("a message with a bare %%");
}

static const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, &places};

static int read_values(void *unit, const Known *variable, double *value)
{
    int whole = 0;
    fmi2Status status;
    if (variable->kind == 'r') return (int)GetReal(unit, &variable->reference, 1, value);
    status = (variable->kind == 'i' ? GetInteger : GetBoolean)(unit, &variable->reference, 1, &whole);
    *value = whole;
    return (int)status;
}

static void create(void)
{
    const fmi2Type type = percent(50) ? fmi2CoSimulation : fmi2ModelExchange;
    Place place = {NULL, NEW, type == fmi2ModelExchange, percent(70), 0.0, INFINITY};
    begin("fmi2Instantiate");
    if (percent(30)) {
        const char *guid = percent(50) ? "{another}" : NULL, *name = percent(50) ? "" : NULL;
        int odd = 2 + (int)below(1000), what = (int)below(3);
        if (Instantiate(what == 0 ? name : "fuzz", what == 1 ? (fmi2Type)odd : type, what == 2 ? guid : token, NULL,
                        percent(90) ? &callbacks : NULL, fmi2False, fmi2False))
            fail("an instance in spite of wrong arguments (%d)", what);
        return;
    }
    place.unit =
        Instantiate("fuzz", type, token, percent(50) ? NULL : "file:///", &callbacks, percent(50), percent(50));
    if (!place.unit || said.count) fail("no instance, or a message");
    *at = place;
}

static fmi2Status with_vectors(int f, const char **wrong)
{
    bool no_references, no_values, set = f == AT_SetReal || f == AT_SetInteger || f == AT_SetBoolean;
    size_t count, others_count = below(5);
    const bool real = f == AT_GetReal || f == AT_SetReal;
    switch (f) {
    case AT_GetReal: case AT_SetReal: case AT_GetInteger: case AT_SetInteger: case AT_GetBoolean: case AT_SetBoolean: {
        const char kind = real ? 'r' : f == AT_GetInteger || f == AT_SetInteger ? 'i' : 'b';
        *wrong = choose(kind, set, set ? "pids" : "pidosl", &count, &no_references, &no_values);
        const unsigned *r = no_references ? NULL : vr;
        if (real) return set ? SetReal(at->unit, r, count, no_values ? NULL : reals)
                             : GetReal(at->unit, r, count, no_values ? NULL : more);
        int *v = no_values ? NULL : ints;
        if (kind == 'i') return set ? SetInteger(at->unit, r, count, v) : GetInteger(at->unit, r, count, v);
        return set ? SetBoolean(at->unit, r, count, v) : GetBoolean(at->unit, r, count, v);
    }
    case AT_GetString: case AT_SetString:
        count = below(3);
        if (count) *wrong = "no strings";
        if (f == AT_SetString) return SetString(at->unit, vr, count, strings);
        return GetString(at->unit, vr, count, (fmi2String *)more);
    case AT_SetRealInputDerivatives: case AT_GetRealOutputDerivatives:
        set = f == AT_SetRealInputDerivatives;
        *wrong = choose('r', false, set ? "i" : "o", &count, &no_references, &no_values);
        for (size_t i = 0; i < count; i++) {
            ints[i] = percent(95) ? 1 : (int)random_bits();
            if (ints[i] < 1 || ints[i] > 3) *wrong = "order";
            if (set && !isfinite(reals[i])) *wrong = "no number";
        }
        if (set)
            return SetRealInputDerivatives(at->unit, no_references ? NULL : vr, count, ints, no_values ? NULL : reals);
        return GetRealOutputDerivatives(at->unit, no_references ? NULL : vr, count, ints, no_values ? NULL : more);
    default:
        *wrong = choose('r', false, "o", &count, &no_references, &no_values);
        for (size_t i = 0; i < others_count; i++) {
            others[i] = some_variable('r', "i")->reference;
            more[i] = percent(98) ? wild_real() : no_number();
            if (!isfinite(more[i])) *wrong = "no number";
        }
        return GetDirectionalDerivative(at->unit, no_references ? NULL : vr, count, others, others_count, more,
                                        no_values ? NULL : reals);
    }
}

static fmi2Status step(const char **wrong)
{
    double time, h;
    *wrong = choose_step(&time, &h);
    const fmi2Status status = DoStep(at->unit, time, h, percent(50));
    patience = 0;
    look_at_stop((int)status, time + h);
    if (!status) at->time = time + h;
    return status;
}

static int perform(int f, const char **wrong)
{
    const fmi2StatusKind kind = percent(90) ? (fmi2StatusKind)below(4) : (fmi2StatusKind)random_bits();
    const bool nowhere = percent(3);
    fmi2Status status;
    double start, stop;
    int whole;
    fmi2String text;
    fmi2EventInfo info;
    if (f >= AT_GetFMUState && f <= AT_SerializedFMUStateSize) return with_states(f, wrong);
    switch (f) {
    case AT_SetDebugLogging: return SetDebugLogging(at->unit, percent(50), 0, NULL);
    case AT_SetupExperiment:
        start = percent(80) ? unit_random() : percent(50) ? no_number() : wild_real();
        stop = percent(50) ? start + unit_random() : percent(50) ? wild_real() : no_number();
        whole = percent(50);
        if (!isfinite(start) || (whole && !(stop >= start))) *wrong = "no times";
        status = SetupExperiment(at->unit, percent(50), wild_real(), start, whole, stop);
        if (!status) at->time = start, at->stop = whole ? stop : INFINITY;
        return status;
    case AT_DoStep: return step(wrong);
    case AT_CancelStep: return *wrong = "nothing pends", CancelStep(at->unit);
    case AT_GetStatus: return *wrong = "nothing pends", GetStatus(at->unit, kind, &status);
    case AT_GetRealStatus:
        if (nowhere || kind != fmi2LastSuccessfulTime) *wrong = "kind";
        status = GetRealStatus(at->unit, kind, nowhere ? NULL : &start);
        if (!status && start != at->time) fail("time is %.17g, must be %.17g", start, at->time);
        return status;
    case AT_GetIntegerStatus: return *wrong = "no such", GetIntegerStatus(at->unit, kind, &whole);
    case AT_GetBooleanStatus:
        if (nowhere || kind != fmi2Terminated) *wrong = "kind";
        return GetBooleanStatus(at->unit, kind, nowhere ? NULL : &whole);
    case AT_GetStringStatus: return *wrong = "no such", GetStringStatus(at->unit, kind, &text);
    case AT_EnterInitializationMode: status = EnterInitializationMode(at->unit); break;
    case AT_ExitInitializationMode: status = ExitInitializationMode(at->unit); break;
    case AT_Terminate: status = Terminate(at->unit); break;
    case AT_Reset: status = Reset(at->unit); break;
    case AT_EnterEventMode: status = EnterEventMode(at->unit); break;
    case AT_EnterContinuousTimeMode: status = EnterContinuousTimeMode(at->unit); break;
    case AT_NewDiscreteStates:
        if (nowhere) *wrong = "NULL";
        return NewDiscreteStates(at->unit, nowhere ? NULL : &info);
    default: return f >= AT_CompletedIntegratorStep ? in_exchange(f, wrong) : (int)with_vectors(f, wrong);
    }
    if (status) return status;
    if (f == AT_Reset) at->time = 0.0, at->stop = INFINITY;
    at->phase = f == AT_EnterInitializationMode ? INIT : f == AT_Terminate ? END : f == AT_Reset ? NEW
              : f == AT_ExitInitializationMode ? (at->exchange ? EVENT : STEP) : f == AT_EnterEventMode ? EVENT : TIME;
    return status;
}

