/* A host in C for native FMUs for co-simulation, FMI 2.0: lives of instances, one after the other.

   host LIBRARY TOKEN LIVES STEP INPUT BASE SWING OUTPUT OUTPUTS

   Each life: instantiate, initialise, steps, save, step, restore, step again, serialise, free the state, make
   it of the bytes again, restore, step again, terminate, reset or not, free. The input is
   BASE + SWING sin(i) before step i of the process. The OUTPUTS outputs from reference OUTPUT on must be the
   same bits after all three steps from the same state. Ends with 1 at the first difference, with 4 where a call
   fails; else it prints

       calls CALLS seconds SECONDS memory FIRST LAST

   with the resident memory in bytes after a tenth of the lives and at the end. */

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fmi2Functions.h"

#define STEPS 3 /* before the state is saved */

static long calls;
static void *library;

static void logger(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    (void)environment;
    fprintf(stderr, "%s: status %d, %s: %s\n", instance, status, category, message);
}

static void *find(const char *name)
{
    void *function = dlsym(library, name);
    if (!function) {
        fprintf(stderr, "%s\n", dlerror());
        exit(3);
    }
    return function;
}

#define FIND(name) fmi2##name##TYPE *name = (fmi2##name##TYPE *)find("fmi2" #name)
#define DO(name, ...)                                               \
    do {                                                            \
        fmi2Status status_of_call = name(__VA_ARGS__);              \
        calls++;                                                    \
        if (status_of_call != fmi2OK) {                             \
            fprintf(stderr, #name ": status %d\n", status_of_call); \
            return 4;                                               \
        }                                                           \
    } while (0)

/* In bytes; what /proc/self/statm tells is not exact. */
static long resident(void)
{
    char line[256];
    long kilobytes = 0;
    FILE *file = fopen("/proc/self/smaps_rollup", "r");
    if (!file) return 0;
    while (fgets(line, sizeof line, file))
        if (sscanf(line, "Rss: %ld kB", &kilobytes) == 1) break;
    fclose(file);
    return 1024 * kilobytes;
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

int main(int argc, char **argv)
{
    if (argc != 10) return 2;
    library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        return 3;
    }
    const long lives = strtol(argv[3], NULL, 10);
    const double step = strtod(argv[4], NULL), base = strtod(argv[6], NULL), swing = strtod(argv[7], NULL);
    const fmi2ValueReference input = (fmi2ValueReference)strtoul(argv[5], NULL, 10);
    const size_t outputs = strtoul(argv[9], NULL, 10), size_of_outputs = outputs * sizeof(double);
    fmi2ValueReference *output = calloc(outputs, sizeof *output);
    double *first = calloc(outputs, sizeof *first), *again = calloc(outputs, sizeof *again);
    for (size_t i = 0; i < outputs; i++) output[i] = (fmi2ValueReference)(strtoul(argv[8], NULL, 10) + i);

    FIND(Instantiate);
    FIND(SetupExperiment);
    FIND(EnterInitializationMode);
    FIND(ExitInitializationMode);
    FIND(SetReal);
    FIND(GetReal);
    FIND(DoStep);
    FIND(GetFMUstate);
    FIND(SetFMUstate);
    FIND(FreeFMUstate);
    FIND(SerializedFMUstateSize);
    FIND(SerializeFMUstate);
    FIND(DeSerializeFMUstate);
    FIND(Terminate);
    FIND(Reset);
    FIND(FreeInstance);
    const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};

    long memory = 0, count = 0;
    const double begin = now();
    for (long life = 0; life < lives; life++) {
        double value, t = 0.0;
        size_t size;
        fmi2FMUstate state = NULL;
        fmi2Component unit = Instantiate("lives", fmi2CoSimulation, argv[2], "", &callbacks, fmi2False, fmi2False);
        if (!unit) return 4;
        DO(SetupExperiment, unit, fmi2False, 0.0, t, fmi2False, 0.0);
        DO(EnterInitializationMode, unit);
        DO(ExitInitializationMode, unit);
        for (int i = 0; i < STEPS; i++, t += step) {
            value = base + swing * sin((double)count++);
            DO(SetReal, unit, &input, 1, &value);
            DO(DoStep, unit, t, step, fmi2False);
        }
        DO(GetFMUstate, unit, &state);
        DO(DoStep, unit, t, step, fmi2False);
        DO(GetReal, unit, output, outputs, first);
        for (int from_bytes = 0; from_bytes < 2; from_bytes++) {
            if (from_bytes) {
                DO(SerializedFMUstateSize, unit, state, &size);
                fmi2Byte *bytes = malloc(size);
                DO(SerializeFMUstate, unit, state, bytes, size);
                DO(FreeFMUstate, unit, &state);
                DO(DeSerializeFMUstate, unit, bytes, size, &state);
                free(bytes);
            }
            DO(SetFMUstate, unit, state);
            DO(DoStep, unit, t, step, fmi2False);
            DO(GetReal, unit, output, outputs, again);
            if (memcmp(first, again, size_of_outputs)) {
                fprintf(stderr, "life %ld: another step after the state was %s\n", life,
                        from_bytes ? "read from bytes" : "restored");
                return 1;
            }
        }
        DO(FreeFMUstate, unit, &state);
        DO(Terminate, unit);
        if (life % 2) DO(Reset, unit);
        FreeInstance(unit);
        calls += 2;
        if (life == lives / 10) memory = resident();
    }
    printf("calls %ld seconds %g memory %ld %ld\n", calls, now() - begin, memory, resident());
    free(output), free(first), free(again);
    dlclose(library);
    return 0;
}
