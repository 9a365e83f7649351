/* What the two files over FMI 2.0 share. */
#ifndef FMI2_H
#define FMI2_H

#include "fmi2Functions.h"
#include "instance.h"

#define INSTANCE ((Instance *)handle)
/* Leaves with an error where there is no instance, or the call is not allowed now. */
#define NEEDS(phases, call)                                                \
    do {                                                                   \
        if (!handle || !instance_may(INSTANCE, phases, call)) return fmi2Error; \
    } while (0)
#define MOVING (STEPPING | EVENT | CONTINUOUS)
#define SETTABLE (INSTANTIATED | INITIALIZING | MOVING)
#define READABLE (INITIALIZING | MOVING | TERMINATED)
#define DIFFERENTIABLE READABLE
#define ANY (INSTANTIATED | READABLE)

/* For common_calls.h. */
#define FMI2_(name) fmi2##name
#define FMI(name) FMI2_(name)
#define STATUS fmi2Status
#define HANDLE fmi2Component
#define NEEDS_EXCHANGE NEEDS
#define DERIVATIVES GetDerivatives
#define STATE FMUstate
#define GET_STATE GetFMUstate
#define SET_STATE SetFMUstate
#define FREE_STATE FreeFMUstate
#define STATE_SIZE SerializedFMUstateSize
#define SERIALIZE_STATE SerializeFMUstate
#define DESERIALIZE_STATE DeSerializeFMUstate

#endif
