/* As fuzz.c, for FMI 3.0; the host also makes calls at random from within steps, in the intermediate update. */

#include "fuzz_host.h"

#include "fmi3Functions.h"
#include "fuzz3_absent.h"

#define SET (NEW | INIT | MOVING)
#define GET (NEW | INIT | MOVING | END)
#define SLOPES (INIT | MOVING | END)
#define ANY GET
#define CALLS(F)                                                                                                \
    F(SetDebugLogging, ANY) F(EnterInitializationMode, NEW) F(ExitInitializationMode, INIT) F(Terminate, MOVING) \
    F(Reset, ANY) F(GetFloat64, GET) F(GetInt32, GET) F(GetInt64, GET) F(GetBoolean, GET) F(SetFloat64, SET)    \
    F(SetInt32, SET) F(SetInt64, SET) F(SetBoolean, SET) F(GetOutputDerivatives, SLOPES)                        \
    F(GetDirectionalDerivative, SLOPES) F(GetAdjointDerivative, SLOPES) F(GetFMUState, ANY) F(SetFMUState, ANY) \
    F(FreeFMUState, ANY) F(SerializedFMUStateSize, ANY) F(SerializeFMUState, ANY) F(DeserializeFMUState, ANY)   \
    F(EnterEventMode, MOVING) F(UpdateDiscreteStates, EVENT) F(EnterStepMode, EVENT) F(DoStep, STEP)            \
    F(EnterContinuousTimeMode, EVENT) F(CompletedIntegratorStep, TIME) F(SetTime, EVENT | TIME)                 \
    F(SetContinuousStates, EVENT | TIME) F(GetContinuousStates, SLOPES) F(GetContinuousStateDerivatives, SLOPES) \
    F(GetEventIndicators, SLOPES) F(GetNominalsOfContinuousStates, ANY) F(GetNumberOfEventIndicators, ANY)      \
    F(GetNumberOfContinuousStates, ANY) ABSENT(F) ABSENT_OTHERS(F)
#define INDEX(name, phases) AT_##name,
#define POINTER(name, phases) static fmi3##name##TYPE *name;
#define PHASES(name, phases) phases,
#define NAME(name, phases) "fmi3" #name,
enum { CALLS(INDEX) FUNCTIONS };
CALLS(POINTER)
static const int allowed[] = {CALLS(PHASES)};
static const char *const names[] = {CALLS(NAME)};

static fmi3InstantiateCoSimulationTYPE *InstantiateCoSimulation;
static fmi3InstantiateModelExchangeTYPE *InstantiateModelExchange;
static fmi3FreeInstanceTYPE *FreeInstance;
static struct {
    bool events, early; /* the host handles events; steps may end before their time */
} hosts[INSTANCES];
static fmi3Int64 longs[MOST * LONGEST];
static bool truths[MOST * LONGEST];

static void logger(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    if (environment != &places) fail("a logger with another environment");
    listen((int)status, "fuzz", category, message);
}

static int read_values(void *unit, const Known *variable, double *found)
{
    const fmi3ValueReference *r = &variable->reference;
    const size_t size = variable->size;
    fmi3Int32 whole[LONGEST] = {0};
    fmi3Int64 choice[LONGEST] = {0};
    bool truth[LONGEST] = {false};
    fmi3Status status;
    if (variable->kind == 'r') return (int)GetFloat64(unit, r, 1, found, size);
    if (variable->kind == 'i') status = GetInt32(unit, r, 1, whole, size);
    else if (variable->kind == 'e') status = GetInt64(unit, r, 1, choice, size);
    else status = GetBoolean(unit, r, 1, truth, size);
    for (size_t i = 0; i < size; i++) found[i] = whole[i] + (double)choice[i] + truth[i];
    return (int)status;
}

static fmi3Status with_values(int f, const char **wrong)
{
    bool no_references, no_values;
    const bool set = f >= AT_SetFloat64;
    const char kind = "rieb"[f - (set ? AT_SetFloat64 : AT_GetFloat64)];
    size_t count, size;
    *wrong = choose(kind, set, set ? "pid" : "pidol", &count, &no_references, &no_values);
    const fmi3ValueReference *r = no_references ? NULL : vr;
    size = percent(90) ? values : percent(50) ? count : below(MOST);
    if (size != values && (set || size != count)) *wrong = "size";
    for (size_t i = 0; i < values; i++) {
        longs[i] = at->tame ? ints[i] : percent(30) ? INT64_MAX : (fmi3Int64)random_bits() >> below(64);
        truths[i] = ints[i] & 1;
    }
    switch (f) {
#define CASES(Type, place)                                                                         \
    case AT_Get##Type: return Get##Type(at->unit, r, count, no_values ? NULL : (place), size);      \
    case AT_Set##Type: return Set##Type(at->unit, r, count, no_values ? NULL : (place), size);
        CASES(Float64, reals)
        CASES(Int32, ints)
        CASES(Int64, longs)
    default:
        CASES(Boolean, truths)
    }
}

static fmi3Status with_derivatives(int f, const char **wrong)
{
    bool no_references, no_values;
    size_t count, knowns = below(5), changes = 0;
    *wrong = choose('r', false, "o", &count, &no_references, &no_values);
    const fmi3ValueReference *r = no_references ? NULL : vr;
    double *result = no_values ? NULL : reals;
    for (size_t i = 0; i < count; i++) ints[i] = percent(95) ? 1 : (int)random_bits();
    if (f == AT_GetOutputDerivatives) return GetOutputDerivatives(at->unit, r, count, ints, result, values);
    const bool adjoint = f == AT_GetAdjointDerivative;
    if (adjoint && !knowns) *wrong = NULL; /* nothing is asked for */
    for (size_t i = 0; i < knowns; i++) {
        const Known *v = some_variable('r', percent(50) ? "i" : "ip");
        others[i] = v->reference;
        changes += v->size;
    }
    const size_t seeds = adjoint ? values : changes, given = percent(95) ? seeds : below(MOST);
    for (size_t i = 0; i < seeds; i++) {
        more[i] = percent(99) ? wild_real() : no_number();
        if (!isfinite(more[i])) *wrong = "no number";
    }
    if (given != seeds) *wrong = "size";
    if (!adjoint) return GetDirectionalDerivative(at->unit, r, count, others, knowns, more, given, result, values);
    return GetAdjointDerivative(at->unit, r, count, others, knowns, more, given, result, changes);
}

static fmi3Status with_states(int f, const char **wrong)
{
    Kept *some = &kept[below(KEPT)];
    const bool nowhere = percent(3), seen = at->unit && percent(50);
    fmi3Status status;
    size_t size = 0;
    switch (f) {
    case AT_GetFMUState:
        if (nowhere) return *wrong = "NULL", GetFMUState(at->unit, NULL);
        if (seen) look(at->unit, some->values);
        status = GetFMUState(at->unit, &some->state);
        if (!status) was_kept(some, seen);
        return status;
    case AT_SetFMUState:
        *wrong = foreign(some);
        status = SetFMUState(at->unit, some->state);
        if (!status) was_restored(some);
        return status;
    case AT_FreeFMUState: return FreeFMUState(at->unit, nowhere ? NULL : &some->state);
    case AT_SerializedFMUStateSize:
        if (nowhere || !some->state) *wrong = "NULL";
        return SerializedFMUStateSize(at->unit, some->state, nowhere ? NULL : &size);
    case AT_SerializeFMUState:
        size = percent(80) ? BYTES : below(100);
        if (nowhere || !some->state || size < 100) *wrong = "NULL, or no room";
        status = SerializeFMUState(at->unit, some->state, nowhere ? NULL : (fmi3Byte *)bytes.data, size);
        if (status) return status;
        if (SerializedFMUStateSize(at->unit, some->state, &size)) fail("no size");
        was_written(some, size);
        return status;
    default:
        if (damaged() || nowhere) *wrong = "damaged";
        status = DeserializeFMUState(at->unit, (fmi3Byte *)bytes.data, bytes.size, nowhere ? NULL : &some->state);
        if (status) return status;
        bytes.of.state = some->state;
        *some = bytes.of;
        return status;
    }
}

static fmi3Status in_exchange(int f, const char **wrong)
{
    const bool nowhere = percent(3);
    const size_t proper = f == AT_GetEventIndicators ? indicators : states, count = percent(80) ? proper : below(MOST);
    double *values = nowhere ? NULL : reals, time;
    size_t number = 0;
    fmi3Boolean enter, end;
    fmi3Status status;
    if (!at->exchange) *wrong = "co-simulation";
    if (f >= AT_SetContinuousStates && f < AT_GetNumberOfEventIndicators && ((nowhere && count) || count != proper))
        *wrong = "size";
    switch (f) {
    case AT_EnterContinuousTimeMode:
        status = EnterContinuousTimeMode(at->unit);
        if (!status) at->phase = TIME;
        return status;
    case AT_CompletedIntegratorStep:
        if (nowhere) *wrong = "NULL";
        return CompletedIntegratorStep(at->unit, percent(50), nowhere ? NULL : &enter, &end);
    case AT_SetTime:
        time = percent(5) ? no_number() : percent(90) ? at->time + 1e-3 * unit_random() : wild_real();
        if (!isfinite(time)) *wrong = "no number";
        status = SetTime(at->unit, time);
        if (!status) at->time = time;
        return status;
    case AT_SetContinuousStates:
        for (size_t i = 0; i < count; i++) {
            reals[i] = at->tame ? 1e-3 * unit_random() : percent(99) ? wild_real() : no_number();
            if (!isfinite(reals[i])) *wrong = "no number";
        }
        return SetContinuousStates(at->unit, values, count);
    case AT_GetContinuousStates: return GetContinuousStates(at->unit, values, count);
    case AT_GetContinuousStateDerivatives: return GetContinuousStateDerivatives(at->unit, values, count);
    case AT_GetEventIndicators: return GetEventIndicators(at->unit, values, count);
    case AT_GetNominalsOfContinuousStates: return GetNominalsOfContinuousStates(at->unit, values, count);
    default:
        if (nowhere) *wrong = "NULL";
        if (f == AT_GetNumberOfEventIndicators) status = GetNumberOfEventIndicators(at->unit, nowhere ? NULL : &number);
        else status = GetNumberOfContinuousStates(at->unit, nowhere ? NULL : &number);
        if (!status && number != (f == AT_GetNumberOfEventIndicators ? indicators : states)) fail("%zu", number);
        return status;
    }
}

#define CALL_ABSENT
#include "fuzz3_absent.h"

/* The host's part in the course of a step: it may read, set, and ask for an early return, and do nothing else. */
static void update(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean set, fmi3Boolean get,
                   fmi3Boolean finished, fmi3Boolean early, fmi3Boolean *requested, fmi3Float64 *wanted)
{
    const char *ignored;
    const int what = (int)below(10), stepping = at->phase;
    static char outer[sizeof said];
    memcpy(outer, &said, sizeof said);
    said.count = 0;
    if (environment != &places || !isfinite(time) || (finished && set)) fail("an update at %g", time);
    if (what < 5) with_values(AT_GetFloat64 + what % 4, &ignored);
    else if (what < 8) with_values(AT_SetFloat64, &ignored);
    else if (what == 8) with_derivatives(AT_GetOutputDerivatives, &ignored);
    else {
        bool some;
        double reached;
        void *state = NULL;
        if (!DoStep(at->unit, time, 0.0, true, &some, &some, &some, &reached) || !Reset(at->unit) ||
            !Terminate(at->unit) || !GetFMUState(at->unit, &state) || !EnterEventMode(at->unit))
            fail("another call in a step");
        FreeInstance(at->unit); /* ignored */
    }
    if (early && get == finished && percent(20)) {
        *requested = true;
        *wanted = percent(50) ? time + 1e-4 * unit_random() : percent(50) ? wild_real() : no_number();
    }
    at->phase = stepping;
    memcpy(&said, outer, sizeof said);
}

static fmi3Status step(const char **wrong)
{
    const bool nowhere = percent(3);
    bool event = false, terminate = false, early = false;
    double time, h, reached = NAN;
    *wrong = at->exchange ? "model exchange" : NULL;
    const char *misplaced = choose_step(&time, &h);
    if (misplaced || nowhere) *wrong = "no step";
    const fmi3Status status =
        DoStep(at->unit, time, h, percent(50), &event, nowhere ? NULL : &terminate, &early, &reached);
    patience = 0;
    look_at_stop((int)status, time + h);
    if (status) return status;
    const double end = time + h, slack = 1e-9 * (1.0 + fabs(end));
    if (!(reached >= at->time - slack && reached <= end + slack) || terminate) fail("reached %.17g", reached);
    if ((event && !hosts[at - places].events) || (early && !hosts[at - places].early)) fail("not allowed by the host");
    if (!early && reached != end) fail("no early return, but reached %.17g", reached);
    at->time = reached;
    return status;
}

static int perform(int f, const char **wrong)
{
    const bool nowhere = percent(3), has_stop = percent(50);
    bool some[4], defined;
    double start, stop, next;
    fmi3Status status;
    if (f >= AT_GetFloat32) return of_absent(f, wrong);
    if (f >= AT_EnterContinuousTimeMode) return in_exchange(f, wrong);
    if (f >= AT_GetFMUState && f <= AT_DeserializeFMUState) return with_states(f, wrong);
    if (f >= AT_GetOutputDerivatives && f <= AT_GetAdjointDerivative) return with_derivatives(f, wrong);
    if (f >= AT_GetFloat64 && f <= AT_SetBoolean) return with_values(f, wrong);
    switch (f) {
    case AT_SetDebugLogging: return SetDebugLogging(at->unit, percent(50), 0, NULL);
    case AT_EnterInitializationMode:
        start = percent(90) ? unit_random() : percent(50) ? no_number() : wild_real();
        stop = percent(80) ? start + unit_random() : percent(50) ? wild_real() : no_number();
        if (!isfinite(start) || (has_stop && !(stop >= start))) *wrong = "no times";
        status = EnterInitializationMode(at->unit, percent(50), wild_real(), start, has_stop, stop);
        if (!status) at->phase = INIT, at->time = start, at->stop = has_stop ? stop : INFINITY;
        return status;
    case AT_ExitInitializationMode: status = ExitInitializationMode(at->unit); break;
    case AT_Terminate: status = Terminate(at->unit); break;
    case AT_Reset: status = Reset(at->unit); break;
    case AT_EnterEventMode:
        if (!at->exchange && !hosts[at - places].events) *wrong = "without event mode";
        status = EnterEventMode(at->unit);
        break;
    case AT_EnterStepMode:
        if (at->exchange) *wrong = "model exchange";
        status = EnterStepMode(at->unit);
        break;
    case AT_UpdateDiscreteStates:
        if (nowhere) *wrong = "NULL";
        return UpdateDiscreteStates(at->unit, some, some + 1, some + 2, nowhere ? NULL : some + 3, &defined, &next);
    default: return step(wrong);
    }
    if (status) return status;
    if (f == AT_Reset) at->time = 0.0, at->stop = INFINITY;
    const bool events = at->exchange || hosts[at - places].events || f == AT_EnterEventMode;
    at->phase = f == AT_Terminate ? END : f == AT_Reset ? NEW : f != AT_EnterStepMode && events ? EVENT : STEP;
    return status;
}

static int choose_function(void)
{
    if (percent(70)) return (int)below(FUNCTIONS);
    switch (at->phase) {
    case NEW: return AT_EnterInitializationMode;
    case INIT: return AT_ExitInitializationMode;
    case STEP: return AT_DoStep;
    case EVENT:
        if (percent(50)) return AT_UpdateDiscreteStates;
        return at->exchange ? AT_EnterContinuousTimeMode : AT_EnterStepMode;
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

static void create(void)
{
    Place place = {NULL, NEW, percent(40), percent(70), 0.0, INFINITY};
    const char *right = "fuzz", *name = right, *guid = token;
    const bool wrong = percent(20), events = percent(50), early = percent(50), updates = percent(50);
    const unsigned count = below(3);
    begin("fmi3Instantiate");
    if (wrong && percent(50)) name = percent(50) ? "" : NULL;
    else if (wrong) guid = percent(50) ? "{another}" : NULL;
    for (unsigned i = 0; i < count; i++) vr[i] = some_variable('r', "i")->reference;
    if (place.exchange) place.unit = InstantiateModelExchange(name, guid, NULL, false, events, &places, logger);
    else
        place.unit = InstantiateCoSimulation(name, guid, "", false, events, events, early, count ? vr : NULL, count,
                                             &places, logger, updates ? update : NULL);
    if (wrong ? place.unit != NULL || said.count != 1 : !place.unit || said.count) fail("%s", wrong ? "one" : "none");
    if (!place.unit) return;
    hosts[at - places].events = events, hosts[at - places].early = early;
    *at = place;
}

static int free_state(void *unit, void **state) { return (int)FreeFMUState(unit, state); }

int main(int argc, char **argv)
{
    if (argc != 8) return 2;
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return printf("%s\n", dlerror()), 3;
#define FIND(name, phases) name = (fmi3##name##TYPE *)find(library, "fmi3" #name);
    CALLS(FIND)
    FIND(InstantiateCoSimulation, 0)
    FIND(InstantiateModelExchange, 0)
    FIND(FreeInstance, 0)
    play(argv, create, call, FreeInstance, free_state);
    for (int f = 0; f < FUNCTIONS; f++) printf("%s %lu %lu\n", names[f], taken[f], refused[f]);
    dlclose(library);
    return 0;
}
