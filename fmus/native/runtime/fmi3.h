/* What the files over FMI 3.0 share. */
#ifndef FMI3_H
#define FMI3_H

#include "fmi3Functions.h"
#include "instance.h"

/* An instance, and what the host asked of it when it made it. */
typedef struct {
    Instance *instance;
    bool event_mode, early_return; /* the host handles events; it lets steps end before their time */
    fmi3IntermediateUpdateCallback update;
    bool given[INPUTS + 1];   /* inputs that the host gives in the course of a step */
    bool gives, setting, getting; /* any of them; what it may do in the present call of its own */
    State before, beginning;      /* of the step that is being made: as the host left it, with all inputs */
} Session;

/* What a list of value references stands for, with one reference for each element. */
typedef struct {
    const uint32_t *references;
    size_t count;
    uint32_t *made; /* to be freed */
    size_t missing; /* elements of arrays that are left out, for a host that knows none */
} Elements;

/* For a call with so many values; false after a message if they are not as many as elements. Where `first` is true, as
   many as variables will do: then they are the first elements. */
bool elements_of(Elements *some, const Instance *instance, const char *call, const fmi3ValueReference vr[],
                 size_t count, size_t values, bool first);

#define SESSION ((Session *)handle)
#define INSTANCE (SESSION->instance)
/* Leaves with an error where there is no instance, or the call is not allowed now. */
#define NEEDS(phases, call)                                                     \
    do {                                                                        \
        if (!handle || !instance_may(INSTANCE, phases, call)) return fmi3Error; \
    } while (0)
/* The same for calls that one of the interface types has, or that need what the host has not asked for. */
#define NEEDS_THAT(condition, phases, call, why)                                                 \
    do {                                                                                         \
        NEEDS(phases, call);                                                                     \
        if (!(condition)) return instance_say(INSTANCE, ERROR, "%s: not allowed %s", call, why); \
    } while (0)
#define MOVING (STEPPING | EVENT | CONTINUOUS)
#define SETTABLE (INSTANTIATED | INITIALIZING | MOVING | INTERMEDIATE)
#define READABLE (INSTANTIATED | INITIALIZING | MOVING | INTERMEDIATE | TERMINATED)
#define DIFFERENTIABLE (INITIALIZING | MOVING | TERMINATED)
#define ANY (INSTANTIATED | DIFFERENTIABLE)

/* For common_calls.h. */
#define FMI3_(name) fmi3##name
#define FMI(name) FMI3_(name)
#define STATUS fmi3Status
#define HANDLE fmi3Instance
#define NEEDS_EXCHANGE(phases, call) NEEDS_THAT(INSTANCE->now.exchange, phases, call, "in co-simulation")
#define DERIVATIVES GetContinuousStateDerivatives
#define STATE FMUState
#define GET_STATE GetFMUState
#define SET_STATE SetFMUState
#define FREE_STATE FreeFMUState
#define STATE_SIZE SerializedFMUStateSize
#define SERIALIZE_STATE SerializeFMUState
#define DESERIALIZE_STATE DeserializeFMUState

#endif
