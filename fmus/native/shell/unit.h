/* One instance of the component: its memory, laid out as memory.py says, and what may be done with it.

   What a call does is told in docs/reference/fmus.md; it is the same as in the FMU that runs in Python (slave.py).
   Nothing here knows a version of FMI. */
#ifndef UNIT_H
#define UNIT_H

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

/* What ranges cannot say (models/requirements.py). A list of them ends with one that has no `met`. */
typedef struct {
    int32_t (*met)(void *result, void **exception, const double *x, const double *u, const double *p, double *told);
    const char *says;         /* with places such as {0:g} for the numbers told, and {word} */
    const char *const *words; /* of which the first number told counts one */
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

typedef struct Unit Unit;
typedef void (*Logger)(const Unit *unit, Status status, const char *category, const char *message);

struct Unit {
    State now;
    char *name;
    Logger logger;
    void *environment, *callback; /* the host's, for the logger */
    bool logging;                 /* more than errors */
    double stop;                  /* no step may go beyond; INFINITY where none is known */
    double work[WORK_SIZE], rates_work[RATES_WORK_SIZE], slopes[INPUTS + 1], all_rates[OUTPUTS + 1], dx[STATES + 1],
        guards[GUARDS + 1];
};

Unit *unit_new(const char *name, Logger logger, void *environment, void *callback, bool logging);
void unit_free(Unit *unit);
void unit_reset(Unit *unit);

/* Tells the host; returns `status`. */
Status unit_say(const Unit *unit, Status status, const char *format, ...);
/* Whether a call is allowed now; says so if not. */
bool unit_may(const Unit *unit, int phases, const char *call);
/* Adds to the message what is not met; false if all are. */
bool unit_unmet(const Unit *unit, const Requirement *requirements, char *message, size_t size);
/* Whether parameters that were set after the initialisation are not allowed; says so with that status. */
bool unit_refuses_parameters(Unit *unit, Status status);

Status unit_initialize(Unit *unit);                   /* at the end of the initialisation */
Status unit_step(Unit *unit, double time, double step); /* DISCARD, and nothing changed, if it cannot be made */

/* When the experiment begins and, if that is defined, stops; ERROR, and nothing changed, for what cannot be. */
Status unit_set_times(Unit *unit, double start, bool stop_defined, double stop);
/* Whether a step goes beyond the stop time; says so. Where the host adds up time to it, rounding is allowed. */
bool unit_goes_too_far(const Unit *unit, double time, double step);

/* Values by reference. Nothing is set unless all can be. Kind: of the call. */
Status unit_can_set(const Unit *unit, Kind kind, const uint32_t *references, size_t count, const double *values);
Status unit_set(Unit *unit, Kind kind, const uint32_t *references, size_t count, const double *values);
Status unit_get(Unit *unit, Kind kind, const uint32_t *references, size_t count, double *values);
/* A value as a whole number, or the limit that it is beyond. */
int64_t unit_whole(double value, int64_t low, int64_t high);

/* Computes what is stale of the variables up to this reference. */
void unit_ready(Unit *unit, uint32_t highest);
/* The changes of unknown variables when known ones change, by the first derivative. */
Status unit_directional(Unit *unit, const uint32_t *unknown, size_t unknowns, const uint32_t *known, size_t knowns,
                        const double *changes, double *result);

/* A variable by its reference, also a state, the derivative of one, time, an event indicator; NULL if there is
   none. */
const Variable *unit_variable(uint32_t reference);
const char *unit_name(const Variable *variable);

/* In model exchange: continuous states, their rates and sizes, what indicates events, and events. */
void unit_get_states(const Unit *unit, double *x);
Status unit_set_states(Unit *unit, const double *x);
void unit_derivatives(Unit *unit, double *dx);
void unit_all_derivatives(Unit *unit, double *dx); /* of modes and counts, too */
void unit_indicators(Unit *unit, double *g);
bool unit_event_is_due(Unit *unit); /* a guard has fallen, perhaps unseen, between two looks of the host */
/* Performs the events that are due. `changed`: states were; `next`: the time of the next known one, or INFINITY. */
Status unit_events(Unit *unit, bool *changed, double *next);

/* A saved state as bytes: what wrote it, the state, and a sum by which damage is seen. */
size_t unit_saved_size(void);
void unit_save(const State *state, unsigned char *bytes);
Status unit_restore(const Unit *unit, State *state, const unsigned char *bytes, size_t size);

/* States that the host keeps, with messages for what it does wrong. */
Status unit_keep(const Unit *unit, void **kept);
Status unit_put_back(Unit *unit, const void *kept);
Status unit_forget(void **kept);
Status unit_kept_size(const Unit *unit, const void *kept, size_t *size);
Status unit_kept_to_bytes(const Unit *unit, const void *kept, void *bytes, size_t size);
Status unit_kept_from_bytes(const Unit *unit, const void *bytes, size_t size, void **kept);

/* First derivatives of continuous outputs by time. */
Status unit_output_derivatives(Unit *unit, const uint32_t *references, size_t count, const int32_t *orders,
                               double *values);

#endif
