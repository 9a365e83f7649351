/* What the two files over FMI 2.0 share. */
#ifndef FMI2_H
#define FMI2_H

#include "fmi2Functions.h"
#include "instance.h"

#define INSTANCE ((Instance *)c)
/* Leaves with an error where there is no instance, or the call is not allowed now. */
#define NEEDS(phases, call)                                                \
    do {                                                                   \
        if (!c || !instance_may(INSTANCE, phases, call)) return fmi2Error; \
    } while (0)
#define MOVING (STEPPING | EVENT | CONTINUOUS)
#define SETTABLE (INSTANTIATED | INITIALIZING | MOVING)
#define READABLE (INITIALIZING | MOVING | TERMINATED)
#define ANY (INSTANTIATED | READABLE)

#endif
