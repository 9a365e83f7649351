/* Calls a native FMU, FMI 2.0, at random: any function, in any phase, with any arguments.

   fuzz LIBRARY TOKEN VARIABLES STATES INDICATORS SEED CALLS

   VARIABLES is a file with a line "reference kind causality change start" for each variable (fuzz.h). What must
   hold is in fuzz.h (`judge`); besides, a refusal changes no value, and a restored state gives the values of when
   it was saved. At the end a line "call OK refused" for each function. */

#include "fuzz_host.h"

#include "fmi2Functions.h"

/* The functions, and the phases in which the FMU takes them: those of the standard, and where nothing forbids it
   by its sense, some more (a host may look at states while it initialises). */
#define SET (NEW | INIT | MOVING)
#define GET (INIT | MOVING | END)
#define ANY (NEW | GET)
#define CALLS(F)                                                                                                    \
    F(SetDebugLogging, ANY) F(SetupExperiment, NEW) F(EnterInitializationMode, NEW) F(ExitInitializationMode, INIT) \
    F(Terminate, MOVING) F(Reset, ANY) F(GetReal, GET) F(GetInteger, GET) F(GetBoolean, GET) F(GetString, GET)      \
    F(SetReal, SET) F(SetInteger, SET) F(SetBoolean, SET) F(SetString, SET) F(SetRealInputDerivatives, SET)         \
    F(GetRealOutputDerivatives, GET) F(GetFMUstate, ANY) F(SetFMUstate, ANY) F(FreeFMUstate, ANY)                   \
    F(SerializeFMUstate, ANY) F(DeSerializeFMUstate, ANY) F(SerializedFMUstateSize, ANY)                            \
    F(GetDirectionalDerivative, GET) F(DoStep, STEP) F(CancelStep, 0) F(GetStatus, 0) F(GetRealStatus, STEP | END)  \
    F(GetIntegerStatus, 0) F(GetBooleanStatus, STEP | END) F(GetStringStatus, 0) F(EnterEventMode, EVENT | TIME)    \
    F(NewDiscreteStates, EVENT) F(EnterContinuousTimeMode, EVENT) F(CompletedIntegratorStep, TIME)                  \
    F(SetTime, EVENT | TIME) F(SetContinuousStates, EVENT | TIME) F(GetContinuousStates, GET)                      \
    F(GetDerivatives, GET) F(GetEventIndicators, GET) F(GetNominalsOfContinuousStates, ANY)
#define INDEX(name, phases) AT_##name,
#define POINTER(name, phases) static fmi2##name##TYPE *name;
#define PHASES(name, phases) phases,
#define NAME(name, phases) "fmi2" #name,
enum { CALLS(INDEX) FUNCTIONS };
CALLS(POINTER)
static const int allowed[] = {CALLS(PHASES)};
static const char *const names[] = {CALLS(NAME)};

static const fmi2String strings[MOST];
static fmi2InstantiateTYPE *Instantiate;
static fmi2FreeInstanceTYPE *FreeInstance;

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

static fmi2Status with_states(int f, const char **wrong)
{
    Kept *some = &kept[below(KEPT)];
    const bool nowhere = percent(3);
    bool seen;
    fmi2Status status;
    size_t size = 0;
    switch (f) {
    case AT_GetFMUstate:
        if (nowhere) return *wrong = "NULL", GetFMUstate(at->unit, NULL);
        seen = at->unit && at->phase & GET && percent(50);
        if (seen) look(at->unit, some->values);
        status = GetFMUstate(at->unit, &some->state);
        if (!status) was_kept(some, seen);
        return status;
    case AT_SetFMUstate:
        *wrong = foreign(some);
        status = SetFMUstate(at->unit, some->state);
        if (!status) was_restored(some);
        return status;
    case AT_FreeFMUstate:
        return FreeFMUstate(at->unit, nowhere ? NULL : &some->state);
    case AT_SerializedFMUstateSize:
        if (nowhere || !some->state) *wrong = "NULL";
        return SerializedFMUstateSize(at->unit, some->state, nowhere ? NULL : &size);
    case AT_SerializeFMUstate:
        size = percent(80) ? BYTES : below(100);
        if (nowhere || !some->state) *wrong = "NULL";
        if (size < 100) *wrong = "no room";
        status = SerializeFMUstate(at->unit, some->state, nowhere ? NULL : bytes.data, size);
        if (status) return status;
        if (SerializedFMUstateSize(at->unit, some->state, &size)) fail("no size");
        was_written(some, size);
        return status;
    default:
        if (damaged() || nowhere) *wrong = "damaged";
        status = DeSerializeFMUstate(at->unit, bytes.size ? bytes.data : NULL, bytes.size,
                                     nowhere ? NULL : &some->state);
        if (status) return status;
        bytes.of.state = some->state;
        *some = bytes.of;
        return status;
    }
}

static fmi2Status with_vectors(int f, const char **wrong)
{
    bool no_references, no_values, set = f == AT_SetReal || f == AT_SetInteger || f == AT_SetBoolean;
    size_t count, others_count = below(5);
    const bool real = f == AT_GetReal || f == AT_SetReal;
    switch (f) {
    case AT_GetReal: case AT_SetReal: case AT_GetInteger: case AT_SetInteger: case AT_GetBoolean: case AT_SetBoolean: {
        const char kind = real ? 'r' : f == AT_GetInteger || f == AT_SetInteger ? 'i' : 'b';
        *wrong = choose(kind, set, set ? "pid" : "pidol", &count, &no_references, &no_values);
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

static fmi2Status in_exchange(int f, const char **wrong)
{
    const bool nowhere = percent(3);
    double *values = nowhere ? NULL : reals;
    size_t count = percent(80) ? (f == AT_GetEventIndicators ? indicators : states) : below(MOST);
    fmi2EventInfo info;
    fmi2Boolean enter, end;
    double time;
    if (f >= AT_SetContinuousStates) {
        if ((nowhere && count) || count != (f == AT_GetEventIndicators ? indicators : states)) *wrong = "size";
    } else if (nowhere && (f == AT_NewDiscreteStates || f == AT_CompletedIntegratorStep)) *wrong = "NULL";
    switch (f) {
    case AT_NewDiscreteStates: return NewDiscreteStates(at->unit, nowhere ? NULL : &info);
    case AT_CompletedIntegratorStep:
        return CompletedIntegratorStep(at->unit, percent(50), nowhere ? NULL : &enter, &end);
    case AT_SetTime:
        time = percent(5) ? no_number() : percent(90) ? at->time + 1e-3 * unit_random() : wild_real();
        if (!isfinite(time)) *wrong = "no number";
        fmi2Status status = SetTime(at->unit, time);
        if (!status) at->time = time;
        return status;
    case AT_SetContinuousStates:
        for (size_t i = 0; i < count; i++) {
            reals[i] = at->tame ? 1e-3 * unit_random() : percent(99) ? wild_real() : no_number();
            if (!isfinite(reals[i])) *wrong = "no number";
        }
        return SetContinuousStates(at->unit, values, count);
    case AT_GetContinuousStates: return GetContinuousStates(at->unit, values, count);
    case AT_GetDerivatives: return GetDerivatives(at->unit, values, count);
    case AT_GetEventIndicators: return GetEventIndicators(at->unit, values, count);
    default: return GetNominalsOfContinuousStates(at->unit, values, count);
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
    case AT_GetFMUstate: case AT_SetFMUstate: case AT_FreeFMUstate: case AT_SerializeFMUstate:
    case AT_DeSerializeFMUstate: case AT_SerializedFMUstateSize: return with_states(f, wrong);
    case AT_EnterInitializationMode: status = EnterInitializationMode(at->unit); break;
    case AT_ExitInitializationMode: status = ExitInitializationMode(at->unit); break;
    case AT_Terminate: status = Terminate(at->unit); break;
    case AT_Reset: status = Reset(at->unit); break;
    case AT_EnterEventMode: status = EnterEventMode(at->unit); break;
    case AT_EnterContinuousTimeMode: status = EnterContinuousTimeMode(at->unit); break;
    default: return f >= AT_NewDiscreteStates ? in_exchange(f, wrong) : with_vectors(f, wrong);
    }
    if (status) return status;
    if (f == AT_Reset) at->time = 0.0, at->stop = INFINITY;
    at->phase = f == AT_EnterInitializationMode ? INIT : f == AT_Terminate ? END : f == AT_Reset ? NEW
              : f == AT_ExitInitializationMode ? (at->exchange ? EVENT : STEP) : f == AT_EnterEventMode ? EVENT : TIME;
    return status;
}

/* Mostly any function; often the one that leads on, so that every phase is seen. */
static int choose_function(void)
{
    if (percent(80)) return (int)below(FUNCTIONS);
    switch (at->phase) {
    case NEW: return AT_EnterInitializationMode;
    case INIT: return AT_ExitInitializationMode;
    case STEP: return AT_DoStep;
    case EVENT: return percent(50) ? AT_NewDiscreteStates : AT_EnterContinuousTimeMode;
    case TIME: return percent(50) ? AT_SetTime : AT_SetContinuousStates;
    default: return AT_Reset;
    }
}

static void call(void)
{
    const int f = choose_function();
    if (f == AT_Reset && percent(50)) return; /* rarer than what leads away from the start */
    make(f, names[f], allowed[f], GET, perform);
}

static int free_state(void *unit, void **state) { return (int)FreeFMUstate(unit, state); }

int main(int argc, char **argv)
{
    if (argc != 8) return 2;
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return printf("%s\n", dlerror()), 3;
#define FIND(name, phases) name = (fmi2##name##TYPE *)find(library, "fmi2" #name);
    CALLS(FIND)
    Instantiate = (fmi2InstantiateTYPE *)find(library, "fmi2Instantiate");
    FreeInstance = (fmi2FreeInstanceTYPE *)find(library, "fmi2FreeInstance");
    play(argv, create, call, FreeInstance, free_state);
    for (int f = 0; f < FUNCTIONS; f++) printf("%s %lu %lu\n", names[f], taken[f], refused[f]);
    dlclose(library);
    return 0;
}
