/* The functions of both versions of FMI that fuzz.c calls. */
#ifndef FUZZ_FUNCTIONS_H
#define FUZZ_FUNCTIONS_H

/* The functions, and the phases in which the FMU takes them: those of the standard, and where nothing forbids it
   by its sense, some more (a host may look at states while it initialises). */
#if FMI == 2

#include "fmi2Functions.h"

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

/* The names that FMI 3.0 has for them. */
#define GetFMUState GetFMUstate
#define AT_GetFMUState AT_GetFMUstate
#define SetFMUState SetFMUstate
#define AT_SetFMUState AT_SetFMUstate
#define FreeFMUState FreeFMUstate
#define AT_FreeFMUState AT_FreeFMUstate
#define SerializeFMUState SerializeFMUstate
#define AT_SerializeFMUState AT_SerializeFMUstate
#define DeserializeFMUState DeSerializeFMUstate
#define AT_DeserializeFMUState AT_DeSerializeFMUstate
#define SerializedFMUStateSize SerializedFMUstateSize
#define AT_SerializedFMUStateSize AT_SerializedFMUstateSize
#define GetContinuousStateDerivatives GetDerivatives
#define AT_GetContinuousStateDerivatives AT_GetDerivatives

#define VERSIONED(name) fmi2##name
#define TEXT(name) "fmi2" #name

#else

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

#define VERSIONED(name) fmi3##name
#define TEXT(name) "fmi3" #name

#endif

#define INDEX(name, phases) AT_##name,
#define POINTER(name, phases) static VERSIONED(name##TYPE) *name;
#define PHASES(name, phases) phases,
#define NAME(name, phases) TEXT(name),
enum { CALLS(INDEX) FUNCTIONS };
CALLS(POINTER)
static const int allowed[] = {CALLS(PHASES)};
static const char *const names[] = {CALLS(NAME)};

#endif
