/* Calls of fuzz.c that are of FMI 3.0 alone. The host also makes calls at random from within steps, in the
   intermediate update. */
#define INSTANTIATE(F) F(InstantiateCoSimulation, 0) F(InstantiateModelExchange, 0)
#define UPDATE AT_UpdateDiscreteStates
#define RESUME AT_EnterStepMode

static fmi3InstantiateCoSimulationTYPE *InstantiateCoSimulation;
static fmi3InstantiateModelExchangeTYPE *InstantiateModelExchange;
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
    *wrong = choose(kind, set, set ? "pids" : "pidosl", &count, &no_references, &no_values);
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

/* Calls for model exchange that FMI 2.0 does not have, or has in other words. */
static int in_exchange3(int f, const char **wrong)
{
    const bool nowhere = percent(3);
    size_t number = 0;
    int status;
    if (!at->exchange) *wrong = "co-simulation";
    switch (f) {
    case AT_EnterContinuousTimeMode:
        status = (int)EnterContinuousTimeMode(at->unit);
        if (!status) at->phase = TIME;
        return status;
    case AT_GetNumberOfEventIndicators: case AT_GetNumberOfContinuousStates:
        if (nowhere) *wrong = "NULL";
        if (f == AT_GetNumberOfEventIndicators) status = GetNumberOfEventIndicators(at->unit, nowhere ? NULL : &number);
        else status = GetNumberOfContinuousStates(at->unit, nowhere ? NULL : &number);
        if (!status && number != (f == AT_GetNumberOfEventIndicators ? indicators : states)) fail("%zu", number);
        return status;
    default: return in_exchange(f, wrong);
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
    if (f >= AT_EnterContinuousTimeMode) return in_exchange3(f, wrong);
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

