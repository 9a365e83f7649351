/* FMI 3.0 as a WebAssembly component: the world co-simulation-fmu of the draft FMI-LS-WASM (commit c1aac17), by the
   Component Model's canonical ABI, over the functions of fmi3Functions.h. */
#ifdef __wasm__

#include <stdlib.h>
#include <string.h>

#include "fmi3.h"

#define INTERFACE "fmi:fmi3/co-simulation@3.0.0"
#define RESOURCE "co-simulation-instance"
#define METHOD(name) INTERFACE "#[method]" RESOURCE "." name
#define IMPORT(module, name) __attribute__((import_module(module), import_name(name)))
#define EXPORT(name) __attribute__((export_name(name)))
/* A function that hosts call. What it was given and what it tells lies in the memory until they have read it. */
#define CALL(Type, function, name, ...)                        \
    EXPORT("cabi_post_" name) void after_##function(Type told) \
    {                                                          \
        (void)told;                                            \
        release();                                             \
    }                                                          \
    EXPORT(name) Type function(__VA_ARGS__)

IMPORT("fmi:fmi3/callbacks@3.0.0", "log-message")
void log_message(const char *instance, size_t instance_size, fmi3Status status, const char *category,
                 size_t category_size, const char *message, size_t message_size);
IMPORT("fmi:fmi3/intermediate-update-callbacks@3.0.0", "intermediate-update")
void intermediate_update(double time, bool set, bool get, bool finished, bool can_return, void *asked);
IMPORT("[export]" INTERFACE, "[resource-new]" RESOURCE) int32_t new_resource(void *instance);

/* Memory */

typedef struct Block {
    _Alignas(8) struct Block *next;
} Block;

static Block *blocks; /* of the present call */

/* Room for so many elements, or NULL. One byte more ends a string. */
static void *room(uint64_t count, size_t size)
{
    Block *block = count < PTRDIFF_MAX / size ? malloc(sizeof *block + (size_t)count * size + 1) : NULL;
    if (!block) return NULL;
    block->next = blocks;
    blocks = block;
    return block + 1;
}

static void release(void)
{
    while (blocks) {
        Block *next = blocks->next;
        free(blocks);
        blocks = next;
    }
}

/* By which a host makes room for what it gives. */
EXPORT("cabi_realloc") void *cabi_realloc(const void *old, size_t old_size, size_t alignment, size_t size)
{
    void *made = room(size, 1);
    (void)alignment; /* 8 at most */
    if (!made) __builtin_trap();
    if (old_size) memcpy(made, old, old_size < size ? old_size : size);
    return made;
}

/* What a host gave as a string, with its end. */
static const char *ended(char *text, size_t size)
{
    if (!size) return "";
    text[size] = '\0';
    return text;
}

/* What calls tell: variants whose first byte is the case, as the canonical ABI lays them out. */

typedef struct {
    bool failed;
    union {
        uint8_t status;
        struct {
            void *first;
            size_t count;
        };
    };
} Listed;

typedef struct {
    bool failed;
    union {
        uint8_t status;
        uint64_t number;
        struct {
            double reached;
            bool event, terminate, early;
        } step;
        struct {
            bool again, terminate, nominals, states, next_defined;
            double next;
        } events;
    };
} Told;

static Listed listed;
static Told told;

static Listed *list(fmi3Status status, void *first, size_t count)
{
    listed.failed = status > fmi3Warning;
    listed.first = first;
    listed.count = count;
    if (listed.failed) listed.status = (uint8_t)status;
    return &listed;
}

static Told *tell(fmi3Status status)
{
    told.failed = status > fmi3Warning;
    if (told.failed) told.status = (uint8_t)status;
    return &told;
}

/* Callbacks */

/* The length of a text without a last character of which the end was cut off: hosts take UTF-8 only. */
static size_t whole(const char *text)
{
    size_t size = strlen(text), end = size;
    while (end && (text[end - 1] & 0xC0) == 0x80) end--;
    if (!end || !(text[end - 1] & 0x80)) return size;
    return size - end == (text[end - 1] >= '\xF0' ? 3u : text[end - 1] >= '\xE0' ? 2u : 1u) ? size : end - 1;
}

/* A host may call the component from within its call of the host's, which keeps what it has. */
#define OUTSIDE(call)            \
    do {                         \
        Block *kept = blocks;    \
        const Told begun = told; \
        blocks = NULL;           \
        call;                    \
        blocks = kept;           \
        told = begun;            \
    } while (0)

static void say(fmi3InstanceEnvironment name, fmi3Status status, fmi3String category, fmi3String message)
{
    OUTSIDE(log_message(name, strlen(name), status, category, strlen(category), message, whole(message)));
}

static void update(fmi3InstanceEnvironment name, fmi3Float64 time, fmi3Boolean set, fmi3Boolean get,
                   fmi3Boolean finished, fmi3Boolean can_return, fmi3Boolean *requested, fmi3Float64 *when)
{
    struct {
        bool requested;
        double when;
    } asked;
    (void)name;
    OUTSIDE(intermediate_update(time, set, get, finished, can_return, &asked));
    *requested = asked.requested;
    *when = asked.when;
}

/* Life */

CALL(const Listed *, version, "fmi:fmi3/common@3.0.0#get-version", void)
{
    static const char *text[2];
    text[0] = fmi3GetVersion();
    text[1] = (const char *)strlen(text[0]);
    return (const Listed *)text;
}

CALL(const int32_t *, instantiate, INTERFACE "#[static]" RESOURCE ".instantiate-co-simulation", char *name, size_t size,
     char *token, size_t token_size, const char *path, size_t path_size, bool visible, bool logging, bool event_mode,
     bool early_return, const fmi3ValueReference *required, size_t count)
{
    static int32_t option[2];
    char *own = malloc(size + 1);
    Session *made = NULL;
    (void)path; (void)path_size;
    if (own)
        made = fmi3InstantiateCoSimulation(strcpy(own, ended(name, size)), ended(token, token_size), "", visible,
                                           logging, event_mode, early_return, required, count, own, say,
                                           early_return || count ? update : NULL);
    if (!made) free(own);
    option[0] = made != NULL;
    option[1] = made ? new_resource(made) : 0;
    return option;
}

EXPORT(INTERFACE "#[dtor]" RESOURCE) void drop(fmi3Instance handle)
{
    void *name = INSTANCE->environment;
    fmi3FreeInstance(handle);
    free(name);
}

CALL(fmi3Status, set_debug_logging, METHOD("set-debug-logging"), fmi3Instance handle, bool on, const void *categories,
     size_t count)
{
    (void)categories; (void)count; /* all of them */
    return fmi3SetDebugLogging(handle, on, 0, NULL);
}

CALL(fmi3Status, enter_initialization, METHOD("enter-initialization-mode"), fmi3Instance handle, bool tolerance_defined,
     double tolerance, double start, bool stop_defined, double stop)
{
    return fmi3EnterInitializationMode(handle, tolerance_defined, tolerance, start, stop_defined, stop);
}

#define CHANGE(name, Function)                                           \
    CALL(fmi3Status, call_##Function, METHOD(name), fmi3Instance handle) \
    {                                                                    \
        return Function(handle);                                         \
    }

CHANGE("exit-initialization-mode", fmi3ExitInitializationMode)
CHANGE("enter-event-mode", fmi3EnterEventMode)
CHANGE("enter-step-mode", fmi3EnterStepMode)
CHANGE("evaluate-discrete-states", fmi3EvaluateDiscreteStates)
CHANGE("enter-configuration-mode", fmi3EnterConfigurationMode)
CHANGE("exit-configuration-mode", fmi3ExitConfigurationMode)
CHANGE("terminate", fmi3Terminate)
CHANGE("reset", fmi3Reset)

CALL(Told *, update_discrete_states, METHOD("update-discrete-states"), fmi3Instance handle)
{
    return tell(fmi3UpdateDiscreteStates(handle, &told.events.again, &told.events.terminate, &told.events.nominals,
                                         &told.events.states, &told.events.next_defined, &told.events.next));
}

CALL(Told *, do_step, METHOD("do-step"), fmi3Instance handle, double time, double step, bool no_set_state)
{
    return tell(fmi3DoStep(handle, time, step, no_set_state, &told.step.event, &told.step.terminate, &told.step.early,
                           &told.step.reached));
}

/* Variables */

/* How many values there are of these variables; of unknown ones, which calls refuse, one. */
static size_t elements(const fmi3ValueReference *vr, size_t count)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        const Variable *variable = instance_variable(vr[i]);
        sum += variable ? variable->elements : 1;
    }
    return sum < SIZE_MAX ? (size_t)sum : SIZE_MAX;
}

#define OF_VARIABLES fmi3Instance handle, const fmi3ValueReference *vr, size_t count
#define GET(name, Function)                                                   \
    CALL(Listed *, call_##Function, METHOD(name), OF_VARIABLES)               \
    {                                                                         \
        size_t size = elements(vr, count);                                    \
        void *values = room(size, sizeof(double));                            \
        return list(Function(handle, vr, count, values, size), values, size); \
    }
#define SET(name, Function)                                                                        \
    CALL(fmi3Status, call_##Function, METHOD(name), OF_VARIABLES, const void *values, size_t size) \
    {                                                                                              \
        return Function(handle, vr, count, values, size);                                          \
    }
/* Of what no component has: whatever is asked for is refused, and only an empty list is told. */
#define GET_NONE(name, Function, ...)                                   \
    CALL(Listed *, call_##Function, METHOD(name), OF_VARIABLES)         \
    {                                                                   \
        return list(Function(handle, vr, count, __VA_ARGS__), NULL, 0); \
    }
#define SET_NONE(name, Function, ...)                                                              \
    CALL(fmi3Status, call_##Function, METHOD(name), OF_VARIABLES, const void *values, size_t size) \
    {                                                                                              \
        (void)values; (void)size;                                                                  \
        return Function(handle, vr, count, __VA_ARGS__);                                           \
    }
#define NO_TYPE(name, Type, ...)                      \
    GET_NONE("get-" name, fmi3Get##Type, __VA_ARGS__) \
    SET_NONE("set-" name, fmi3Set##Type, __VA_ARGS__)

GET("get-float64", fmi3GetFloat64)
SET("set-float64", fmi3SetFloat64)
GET("get-int32", fmi3GetInt32)
SET("set-int32", fmi3SetInt32)
GET("get-int64", fmi3GetInt64)
SET("set-int64", fmi3SetInt64)
GET("get-boolean", fmi3GetBoolean)
SET("set-boolean", fmi3SetBoolean)
NO_TYPE("float32", Float32, NULL, 0)
NO_TYPE("int8", Int8, NULL, 0)
NO_TYPE("int16", Int16, NULL, 0)
NO_TYPE("uint8", UInt8, NULL, 0)
NO_TYPE("uint16", UInt16, NULL, 0)
NO_TYPE("uint32", UInt32, NULL, 0)
NO_TYPE("uint64", UInt64, NULL, 0)
NO_TYPE("string", String, NULL, 0)
NO_TYPE("binary", Binary, NULL, NULL, 0)
NO_TYPE("clock", Clock, NULL)
NO_TYPE("shift-decimal", ShiftDecimal, NULL)
NO_TYPE("shift-fraction", ShiftFraction, NULL, NULL)
GET_NONE("get-interval-decimal", fmi3GetIntervalDecimal, NULL, NULL)
SET_NONE("set-interval-decimal", fmi3SetIntervalDecimal, NULL)
GET_NONE("get-interval-fraction", fmi3GetIntervalFraction, NULL, NULL, NULL)
SET_NONE("set-interval-fraction", fmi3SetIntervalFraction, NULL, NULL)

CALL(Told *, count_dependencies, METHOD("get-number-of-variable-dependencies"), fmi3Instance handle,
     fmi3ValueReference vr)
{
    return tell(fmi3GetNumberOfVariableDependencies(handle, vr, NULL));
}

CALL(Listed *, dependencies, METHOD("get-variable-dependencies"), fmi3Instance handle, fmi3ValueReference vr)
{
    return list(fmi3GetVariableDependencies(handle, vr, NULL, NULL, NULL, NULL, 0), NULL, 0);
}

/* Derivatives. `by`: the variables of which the result has the elements. */
#define DERIVATIVES_BY(name, Function, by)                                                                 \
    CALL(Listed *, call_##Function, METHOD(name), fmi3Instance handle, const fmi3ValueReference *unknowns, \
         size_t unknowns_size, const fmi3ValueReference *knowns, size_t knowns_size, const double *seed,   \
         size_t seeds)                                                                                     \
    {                                                                                                      \
        size_t size = elements(by, by##_size);                                                             \
        double *values = room(size, sizeof *values);                                                       \
        fmi3Status status =                                                                                \
            Function(handle, unknowns, unknowns_size, knowns, knowns_size, seed, seeds, values, size);     \
        return list(status, values, size);                                                                 \
    }

DERIVATIVES_BY("get-directional-derivative", fmi3GetDirectionalDerivative, unknowns)
DERIVATIVES_BY("get-adjoint-derivative", fmi3GetAdjointDerivative, knowns)

typedef struct {
    fmi3ValueReference reference;
    fmi3Int32 order;
} Request;

CALL(Listed *, output_derivatives, METHOD("get-output-derivatives"), fmi3Instance handle, const Request *requests,
     size_t count)
{
    fmi3ValueReference *vr = room(count, sizeof *vr);
    fmi3Int32 *orders = room(count, sizeof *orders);
    double *values;
    size_t size;
    if (!vr || !orders) return list(instance_say(INSTANCE, ERROR, "out of memory"), NULL, 0);
    for (size_t i = 0; i < count; i++) {
        vr[i] = requests[i].reference;
        orders[i] = requests[i].order;
    }
    size = elements(vr, count);
    values = room(size, sizeof *values);
    return list(fmi3GetOutputDerivatives(handle, vr, count, orders, values, size), values, size);
}

/* The draft has this call; FMI 3.0 does not. */
CALL(fmi3Status, input_derivatives, METHOD("set-input-derivatives"), fmi3Instance handle, const Request *requests,
     size_t count, const double *values, size_t size)
{
    (void)requests; (void)values;
    if (!count && !size) return fmi3OK;
    return instance_say(INSTANCE, ERROR, "set-input-derivatives: set the variables <input>_der1, _der2 and _der3");
}

/* Saved states */

CALL(Listed *, get_state, METHOD("get-fmu-state"), fmi3Instance handle)
{
    size_t size = instance_saved_size();
    void *bytes = room(size, 1);
    fmi3FMUState state = NULL;
    fmi3Status status = fmi3GetFMUState(handle, &state);
    if (status == fmi3OK) status = fmi3SerializeFMUState(handle, state, bytes, size);
    fmi3FreeFMUState(handle, &state);
    return list(status, bytes, size);
}

CALL(fmi3Status, set_state, METHOD("set-fmu-state"), fmi3Instance handle, const fmi3Byte *bytes, size_t size)
{
    fmi3FMUState state = NULL;
    fmi3Status status = fmi3DeserializeFMUState(handle, bytes, size, &state);
    if (status == fmi3OK) status = fmi3SetFMUState(handle, state);
    fmi3FreeFMUState(handle, &state);
    return status;
}

#endif
