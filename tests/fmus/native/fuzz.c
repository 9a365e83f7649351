/* Calls a native FMU, FMI 2.0, at random: any function, in any phase, with any arguments.

   fuzz LIBRARY TOKEN VARIABLES STATES INDICATORS SEED CALLS

   VARIABLES is a file with a line "reference kind causality change start" for each variable (fuzz.h). What must
   hold is in fuzz.h (`judge`); besides, a refusal changes no value, and a restored state gives the values of when
   it was saved. At the end a line "call OK refused" for each function. */

#include "fuzz.h"

#include "fmi2Functions.h"

/* The functions, and the phases in which the FMU takes them: those of the standard, and where nothing forbids it
   by its sense, some more (a host may look at states while it initialises). */
enum { NEW = 1, INIT = 2, STEP = 4, EVENT = 8, TIME = 16, END = 32 };
#define MOVING (STEP | EVENT | TIME)
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
    F(SetTime, EVENT | TIME) F(SetContinuousStates, EVENT | TIME) F(GetContinuousStates, GET) F(GetDerivatives, GET) \
    F(GetEventIndicators, GET) F(GetNominalsOfContinuousStates, ANY)
#define INDEX(name, phases) AT_##name,
#define POINTER(name, phases) static fmi2##name##TYPE *name;
#define PHASES(name, phases) phases,
#define NAME(name, phases) "fmi2" #name,
enum { CALLS(INDEX) FUNCTIONS };
CALLS(POINTER)
static const int allowed[] = {CALLS(PHASES)};
static const char *const names[] = {CALLS(NAME)};
static unsigned long good[FUNCTIONS], refused[FUNCTIONS];

#define INSTANCES 3
#define KEPT 5
#define BYTES 100000

typedef struct {
    fmi2Component unit;
    int phase;
    bool exchange, tame; /* tame ones get values near to their starts */
    double time;
} Place;

typedef struct {
    fmi2FMUstate state;
    int phase;
    bool exchange, tame, seen;
    double time, values[1000];
} Kept;

static Place places[INSTANCES], *at;
static Kept kept[KEPT];
static struct {
    fmi2Byte data[BYTES];
    size_t size;
    Kept of;
    bool damaged;
} bytes;

static unsigned vr[MOST], others[MOST];
static double reals[MOST], more[MOST];
static int ints[MOST];
static const fmi2String strings[MOST];
static double before[1000], after[1000];
static size_t states, indicators; /* as modelDescription.xml tells */
static const char *token;
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

/* All variables' values. The FMU computes what it has put off, so this is not done before every call. */
static void look(fmi2Component unit, double *values)
{
    for (unsigned i = 0; i < known_count; i++) {
        const unsigned reference = known[i].reference;
        int whole = 0;
        fmi2Status status;
        if (known[i].kind == 'r') status = GetReal(unit, &reference, 1, values + i);
        else {
            status = (known[i].kind == 'i' ? GetInteger : GetBoolean)(unit, &reference, 1, &whole);
            values[i] = whole;
        }
        if (status) fail("reading value reference %u: status %d", reference, status);
    }
}

static bool same(const double *a, const double *b)
{
    for (unsigned i = 0; i < known_count; i++)
        if (memcmp(a + i, b + i, sizeof *a)) {
            snprintf(said.message, sizeof said.message, "value reference %u was %.17g and is %.17g",
                     known[i].reference, a[i], b[i]);
            said.count = 1;
            return false;
        }
    return true;
}

/* References for a call of that kind, mostly of those causalities, and values for a call that sets; why it must
   be refused, or NULL. */
static const char *choose(char kind, bool to_set, const char *causalities, size_t *count, bool *no_references, bool *no_values)
{
    const char *wrong = NULL;
    const Known *v;
    bool spoilt = percent(20);
    *count = percent(5) ? 0 : percent(70) ? 1 : percent(95) ? 1 + below(10) : 1 + below(MOST);
    *no_references = *count && percent(3), *no_values = *count && percent(3);
    if (*no_references || *no_values) wrong = "NULL";
    for (size_t i = 0; i < *count; i++) {
        v = spoilt && percent(30) ? any_variable() : some_variable(kind, causalities);
        vr[i] = v->reference;
        if (v->kind != kind) wrong = "another kind";
        if (to_set && strchr("ol", v->causality)) wrong = "calculated";
        if (to_set && v->change == 'f' && !(at->phase & (NEW | INIT))) wrong = "fixed";
        reals[i] = at->tame ? v->start * (1.0 + 0.01 * unit_random()) + (v->start == 0.0) * 1e-6 * unit_random() : wild_real();
        ints[i] = at->tame ? (int)v->start : (int)random_bits() >> below(32);
        if (spoilt && percent(5)) vr[i] = percent(50) ? UINT32_MAX - below(9) : 1000000 + below(1u << 31), wrong = "unknown";
        if (spoilt && percent(5) && to_set && kind == 'r') reals[i] = no_number(), wrong = "no number";
    }
    if (*count && !of_kind[(int)kind]) wrong = "none of that kind";
    return wrong;
}

static void create(void)
{
    const fmi2Type type = percent(50) ? fmi2CoSimulation : fmi2ModelExchange;
    Place place = {NULL, NEW, type == fmi2ModelExchange, percent(70), 0.0};
    begin("fmi2Instantiate");
    if (percent(30)) {
        const char *guid = percent(50) ? "{another}" : NULL, *name = percent(50) ? "" : NULL;
        int odd = 2 + (int)below(1000), what = (int)below(3);
        if (Instantiate(what == 0 ? name : "fuzz", what == 1 ? (fmi2Type)odd : type, what == 2 ? guid : token, NULL,
                        percent(90) ? &callbacks : NULL, fmi2False, fmi2False))
            fail("an instance in spite of wrong arguments (%d)", what);
        return;
    }
    place.unit = Instantiate("fuzz", type, token, percent(50) ? NULL : "file:///", &callbacks, percent(50), percent(50));
    if (!place.unit || said.count) fail("no instance, or a message");
    *at = place;
}

/* Why a state must not be put into the present instance, or NULL. */
static const char *foreign(const Kept *some)
{
    return !some->state ? "no state" : some->exchange != at->exchange ? "of the other interface" : NULL;
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
        if (status) return status;
        some->phase = at->phase, some->exchange = at->exchange, some->tame = at->tame, some->seen = seen, some->time = at->time;
        return status;
    case AT_SetFMUstate:
        *wrong = foreign(some);
        status = SetFMUstate(at->unit, some->state);
        if (status) return status;
        at->phase = some->phase, at->tame = some->tame, at->time = some->time;
        if (!some->seen) return status;
        look(at->unit, after);
        if (!same(some->values, after)) fail("a restored state is another");
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
        bytes.damaged = false, bytes.of = *some;
        if (SerializedFMUstateSize(at->unit, some->state, &bytes.size) || bytes.size > BYTES) fail("no size");
        return status;
    default:
        if (percent(50) && bytes.size) { /* damage */
            const size_t place = random_bits() % bytes.size;
            bytes.damaged = true;
            if (percent(60)) bytes.data[place] ^= (fmi2Byte)(1 << below(8));
            else bytes.size = percent(50) ? place : bytes.size + 1 + below(9);
            if (bytes.size > BYTES) bytes.size = BYTES;
        }
        if (nowhere || bytes.damaged || !bytes.size) *wrong = "damaged";
        status = DeSerializeFMUstate(at->unit, bytes.size ? bytes.data : NULL, bytes.size, nowhere ? NULL : &some->state);
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
    double h = percent(70) ? 1e-3 * unit_random() : percent(50) ? 0.0 : wild_real(), time = at->time;
    if (fabs(h) > 1.0 && fabs(h) < 1e290) h = 1.0; /* more would only take long */
    if (percent(5)) h = no_number();
    if (percent(10)) time = percent(50) ? no_number() : time - 1.0 - unit_random();
    if (!(h >= 0.0) || !isfinite(h) || !isfinite(time)) *wrong = "no step";
    else if (fabs(time - at->time) > 1e-3 * (1.0 + fabs(at->time) + h)) *wrong = "elsewhere";
    if (!at->tame) {
        patience = 1;
        alarm(1);
    }
    static char text[100];
    snprintf(text, sizeof text, "fmi2DoStep from %.17g by %.17g", time, h);
    doing = text;
    fmi2Status status = DoStep(at->unit, time, h, percent(50));
    patience = 0;
    if (!status) at->time = time + h;
    return status;
}

static fmi2Status perform(int f, const char **wrong)
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
        if (!status) at->time = start;
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
    if (f == AT_Reset) at->time = 0.0;
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
    const int f = choose_function(), phase = at->phase;
    const char *wrong = NULL;
    fmi2Component unit = at->unit;
    const bool watched = phase & GET && percent(20);
    if (f == AT_Terminate + 1 && percent(50)) return; /* resets are rarer than what leads away from the start */
    if (watched) look(unit, before);
    if (percent(1)) at->unit = NULL;
    begin(names[f]);
    const fmi2Status status = perform(f, &wrong);
    if (at->unit && !(phase & allowed[f]) && f != AT_GetStatus && f != AT_GetIntegerStatus && f != AT_GetStringStatus &&
        status != fmi2Error)
        fail("status %d in phase %d", status, phase);
    if (!at->unit) {
        if (status != fmi2Error || said.count) fail("status %d without an instance", status);
        at->unit = unit;
        return;
    }
    judge((int)status, wrong, true);
    if (status < fmi2Discard) good[f]++;
    else refused[f]++;
    if (watched && status >= fmi2Discard) {
        look(unit, after);
        if (!same(before, after)) fail("a refusal changed values");
    }
}

int main(int argc, char **argv)
{
    if (argc != 8) return 2;
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return printf("%s\n", dlerror()), 3;
#define FIND(name, phases) name = (fmi2##name##TYPE *)find(library, "fmi2" #name);
    CALLS(FIND)
    Instantiate = (fmi2InstantiateTYPE *)find(library, "fmi2Instantiate");
    FreeInstance = (fmi2FreeInstanceTYPE *)find(library, "fmi2FreeInstance");
    token = argv[2];
    read_variables(argv[3]);
    states = strtoul(argv[4], NULL, 10), indicators = strtoul(argv[5], NULL, 10);
    seed = state_of_random = strtoull(argv[6], NULL, 10);
    const unsigned long calls = strtoul(argv[7], NULL, 10);
    watch();
    while (call_number < calls) {
        at = &places[below(INSTANCES)];
        if (!at->unit) create();
        else if (below(1000) == 0 || sigsetjmp(way_out, 1)) {
            begin("fmi2FreeInstance");
            FreeInstance(at->unit);
            at->unit = NULL;
        } else call();
    }
    for (int i = 0; i < KEPT; i++) { /* any living instance frees them */
        for (at = places; !at->unit; create()) continue;
        if (FreeFMUstate(at->unit, &kept[i].state)) fail("a state cannot be freed");
    }
    for (int i = 0; i < INSTANCES; i++) FreeInstance(places[i].unit);
    for (int f = 0; f < FUNCTIONS; f++) printf("%s %lu %lu\n", names[f], good[f], refused[f]);
    return 0;
}
