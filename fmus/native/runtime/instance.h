/* One instance of the component: its memory, laid out as variable_layout.py says, and what may be done with it.

   docs/reference/fmus.md describes the calls, which do the same as those of the FMU in Python (slave.py). Nothing
   here depends on the version of FMI. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum { REAL, INTEGER, BOOLEAN, ENUMERATION } Kind;
typedef enum { PARAMETER, INPUT, OUTPUT, LOCAL } Causality;

typedef struct {
    Kind kind;
    Causality causality;
    uint32_t elements;   /* that its value reference stands for: of an array as many as follow, 0 for those */
    bool fixed;          /* no longer set once the initialisation is over */
    bool positive;       /* zero excluded */
    double low, high;    /* of what may be set */
} Variable;

/* Conditions besides ranges (models/requirements.py). A list ends with a requirement without `met`. */
typedef struct {
    int32_t (*met)(void *result, void **exception, const double *x, const double *u, const double *p, double *numbers);
    const char *says;         /* with places such as {0:g} for the numbers, and {word} */
    const char *const *words; /* of which the first number counts one */
} Requirement;

#include "sizes.h"

/* Of the component, generated from its metadata (tables.py). */
extern const Variable variables[VARIABLES + STATES + 1 + GUARDS]; /* and states, time, and what indicates events */
/* Two texts of each, one after the other: its name, and what follows the value in messages (unit, meaning,
   range). Pointers to them would make a library for Linux 1 kB larger in the file, by what its loader needs. */
extern const char texts[];
extern const double beginning[SIZE]; /* the memory of a new instance */
extern const double nominal[];       /* of the states */
extern const int started[];          /* states that have start values */
extern const int rated[];            /* outputs that have rates */
extern const int continuous[];       /* states that are no modes or counts */
extern const char *const failures[FAILURES];
extern const Requirement requirements[];       /* of parameters */
extern const Requirement start_requirements[]; /* of states at the start */

/* Of the version of FMI: what it calls kinds, and whether its calls for integers take enumerations. */
extern const char *const kinds[];
extern const bool integers_are_choices;
/* Whether a host may set single states, in continuous-time mode. */
extern const bool states_are_settable;

/* As the numbers of fmi2Status and fmi3Status. */
enum { OK, WARNING, DISCARD, ERROR, FATAL };
typedef int Status;

/* As bits, so that a call can name the phases in which it is allowed. */
typedef enum {
    INSTANTIATED = 1,
    INITIALIZING = 2,
    STEPPING = 4,
    EVENT = 8,
    CONTINUOUS = 16,
    TERMINATED = 32,
    INTERMEDIATE = 64 /* in a call of the host's from within a step */
} Phase;

/* The evolving data: a copy of it is a saved state. */
typedef struct {
    double data[SIZE];
    Phase phase;
    bool exchange; /* the host integrates */
    bool outputs_stale, energies_stale, rates_stale;
    bool parameters_unchecked; /* set since they were looked at */
} State;

#define MESSAGE 2048 /* longest text, with its end */

typedef struct Instance Instance;
typedef void (*Logger)(const Instance *instance, Status status, const char *category, const char *message);

struct Instance {
    State now;
    char *name;
    Logger logger;
    void *environment, *callback; /* the host's, for the logger */
    bool logging;                 /* more than errors */
    double stop;                  /* no step may go beyond; INFINITY where none is known */
    double work[WORK_SIZE], rates_work[RATES_WORK_SIZE], slopes[INPUTS + 1], all_rates[OUTPUTS + 1], dx[STATES + 1],
        guards[GUARDS + 1];
};

Instance *instance_new(const char *name, Logger logger, void *environment, void *callback, bool logging);
void instance_free(Instance *instance);
void instance_reset(Instance *instance);

/* Sends the host a message; returns `status`. */
Status instance_say(const Instance *instance, Status status, const char *format, ...);
/* Whether a call is allowed in this phase; a message if not. */
bool instance_may(const Instance *instance, int phases, const char *call);
/* Adds unmet requirements to the message; false if all are met. */
bool instance_unmet(const Instance *instance, const Requirement *list, char *message, size_t size);
/* Whether parameters set after the initialisation are wrong; then a message with that status. */
bool instance_refuses_parameters(Instance *instance, Status status);

/* At the end of the initialisation. */
Status instance_initialize(Instance *instance);
/* DISCARD, and nothing changed, if the step cannot be made. */
Status instance_step(Instance *instance, double time, double step);

/* After a step: the inputs' polynomials begin where the step has ended. */
void instance_continue_inputs(Instance *instance);

/* When the experiment begins and, if that is defined, stops; ERROR, and nothing changed, for what cannot be. */
Status instance_set_times(Instance *instance, double start, bool stop_defined, double stop);
/* Whether a step ends beyond the stop time, by more than rounding; then a message. */
bool instance_exceeds_stop(const Instance *instance, double time, double step);

/* Values by reference. Nothing is set unless all can be. Kind: of the call. */
Status instance_can_set(const Instance *instance, Kind kind, const uint32_t *references, size_t count,
                        const double *values);
Status instance_set(Instance *instance, Kind kind, const uint32_t *references, size_t count, const double *values);
Status instance_get(Instance *instance, Kind kind, const uint32_t *references, size_t count, double *values);
/* A value as a whole number, or the limit that it is beyond. */
int64_t instance_whole(double value, int64_t low, int64_t high);

/* Computes the variables up to this reference that are out of date. */
void instance_ready(Instance *instance, uint32_t highest);
/* The changes of unknown variables when known ones change, by the first derivative. */
Status instance_directional(Instance *instance, const uint32_t *unknown, size_t unknowns, const uint32_t *known,
                            size_t knowns, const double *changes, double *result);

/* A variable by its reference, also a state, the derivative of one, time, an event indicator; NULL if there is
   none. */
const Variable *instance_variable(uint32_t reference);
const char *instance_name(const Variable *variable);

/* In model exchange: continuous states, their rates and sizes, what indicates events, and events. */
void instance_get_states(const Instance *instance, double *x);
Status instance_set_states(Instance *instance, const double *x);
Status instance_derivatives(Instance *instance, double *dx); /* DISCARD where one is not finite */
void instance_all_derivatives(Instance *instance, double *dx); /* of modes and counts, too */
void instance_indicators(Instance *instance, double *g);
/* DISCARD, and a message: what this reference stands for is not finite, with states and inputs out of their ranges. */
Status instance_undefined(const Instance *instance, uint32_t reference, double value);
bool instance_event_is_due(Instance *instance); /* a guard has fallen, perhaps unseen, between two looks of the host */
/* Performs the events that are due. `changed`: states were; `next`: the time of the next known one, or INFINITY. */
Status instance_events(Instance *instance, bool *changed, double *next);

/* A saved state as bytes: the digest of the code, the state, a checksum. */
size_t instance_saved_size(void);
void instance_save(const State *state, unsigned char *bytes);
Status instance_restore(const Instance *instance, State *state, const unsigned char *bytes, size_t size);

/* States that the host keeps; misuse gives a message. */
Status instance_keep(const Instance *instance, void **kept);
Status instance_put_back(Instance *instance, const void *kept);
Status instance_forget(void **kept);
Status instance_kept_size(const Instance *instance, const void *kept, size_t *size);
Status instance_kept_to_bytes(const Instance *instance, const void *kept, void *bytes, size_t size);
Status instance_kept_from_bytes(const Instance *instance, const void *bytes, size_t size, void **kept);

/* First derivatives of continuous outputs by time. */
Status instance_output_derivatives(Instance *instance, const uint32_t *references, size_t count, const int32_t *orders,
                               double *values);

#endif
