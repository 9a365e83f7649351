/* Calls a native FMU of the version FMI (a macro: 2 or 3) at random: any function, in any phase, with any arguments.

   fuzz LIBRARY TOKEN VARIABLES STATES INDICATORS SEED CALLS

   VARIABLES is a file with a line "reference kind causality change start" for each variable (fuzz.h). What must
   hold is in fuzz.h (`judge`); besides, a refusal changes no value, and a restored state gives the values of when
   it was saved. At the end a line "call OK refused" for each function. */

#include "fuzz_host.h"

#include "fuzz_functions.h"

static VERSIONED(FreeInstanceTYPE) *FreeInstance;

static int with_states(int f, const char **wrong)
{
    Kept *some = &kept[below(KEPT)];
    const bool nowhere = percent(3), seen = at->unit && at->phase & GET && percent(50);
    int status;
    size_t size = 0;
    switch (f) {
    case AT_GetFMUState:
        if (nowhere) return *wrong = "NULL", GetFMUState(at->unit, NULL);
        if (seen) look(at->unit, some->values);
        status = (int)GetFMUState(at->unit, &some->state);
        if (!status) was_kept(some, seen);
        return status;
    case AT_SetFMUState:
        *wrong = foreign(some);
        status = (int)SetFMUState(at->unit, some->state);
        if (!status) was_restored(some);
        return status;
    case AT_FreeFMUState: return (int)FreeFMUState(at->unit, nowhere ? NULL : &some->state);
    case AT_SerializedFMUStateSize:
        if (nowhere || !some->state) *wrong = "NULL";
        return (int)SerializedFMUStateSize(at->unit, some->state, nowhere ? NULL : &size);
    case AT_SerializeFMUState:
        size = percent(80) ? BYTES : below(100);
        if (nowhere || !some->state || size < 100) *wrong = "NULL, or no room";
        status = (int)SerializeFMUState(at->unit, some->state, nowhere ? NULL : (void *)bytes.data, size);
        if (status) return status;
        if (SerializedFMUStateSize(at->unit, some->state, &size)) fail("no size");
        was_written(some, size);
        return status;
    default:
        if (damaged() || nowhere) *wrong = "damaged";
        status = (int)DeserializeFMUState(at->unit, bytes.size ? (void *)bytes.data : NULL, bytes.size,
                                     nowhere ? NULL : &some->state);
        if (status) return status;
        bytes.of.state = some->state;
        *some = bytes.of;
        return status;
    }
}

/* Calls of both versions for model exchange. */
static int in_exchange(int f, const char **wrong)
{
    const bool nowhere = percent(3);
    const size_t proper = f == AT_GetEventIndicators ? indicators : states, count = percent(80) ? proper : below(MOST);
    double *some = nowhere ? NULL : reals, time;
    VERSIONED(Boolean) enter, end;
    int status;
    if (f >= AT_SetContinuousStates && ((nowhere && count) || count != proper)) *wrong = "size";
    switch (f) {
    case AT_CompletedIntegratorStep:
        if (nowhere) *wrong = "NULL";
        return (int)CompletedIntegratorStep(at->unit, percent(50), nowhere ? NULL : &enter, &end);
    case AT_SetTime:
        time = percent(5) ? no_number() : percent(90) ? at->time + 1e-3 * unit_random() : wild_real();
        if (!isfinite(time)) *wrong = "no number";
        status = (int)SetTime(at->unit, time);
        if (!status) at->time = time;
        return status;
    case AT_SetContinuousStates:
        for (size_t i = 0; i < count; i++) {
            reals[i] = at->tame ? 1e-3 * unit_random() : percent(99) ? wild_real() : no_number();
            if (!isfinite(reals[i])) *wrong = "no number";
        }
        return (int)SetContinuousStates(at->unit, some, count);
    case AT_GetContinuousStates: return (int)GetContinuousStates(at->unit, some, count);
    case AT_GetContinuousStateDerivatives: case AT_GetEventIndicators:
        if (f == AT_GetEventIndicators) status = (int)GetEventIndicators(at->unit, some, count);
        else status = (int)GetContinuousStateDerivatives(at->unit, some, count);
        for (size_t i = 0; i < count && !*wrong; i++)
            if (!isfinite(reals[i])) *wrong = "no finite value";
        return status;
    default: return (int)GetNominalsOfContinuousStates(at->unit, some, count);
    }
}

#if FMI == 2
#include "fuzz2.h"
#else
#include "fuzz3.h"
#endif

/* Mostly any function; often the one that leads on, so that every phase is seen. */
static int choose_function(void)
{
    if (percent(75)) return (int)below(FUNCTIONS);
    switch (at->phase) {
    case NEW: return AT_EnterInitializationMode;
    case INIT: return AT_ExitInitializationMode;
    case STEP: return AT_DoStep;
    case EVENT: return percent(50) ? UPDATE : at->exchange ? AT_EnterContinuousTimeMode : RESUME;
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

static int free_state(void *unit, void **state) { return (int)FreeFMUState(unit, state); }

int main(int argc, char **argv)
{
    if (argc != 8) return 2;
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return printf("%s\n", dlerror()), 3;
#define FIND(name, phases) name = (VERSIONED(name##TYPE) *)find(library, TEXT(name));
    CALLS(FIND)
    INSTANTIATE(FIND)
    FIND(FreeInstance, 0)
    play(argv, create, call, FreeInstance, free_state);
    for (int f = 0; f < FUNCTIONS; f++) printf("%s %lu %lu\n", names[f], taken[f], refused[f]);
    dlclose(library);
    return 0;
}
