/* A co-simulation host in C: loads one FMU, steps it with a varying input, prints every output's bits.

   host LIBPYTHON LIBRARY RESOURCES STEPS STEP INPUT OUTPUT [free|keep]

   LIBPYTHON is loaded first, for all to see, because the FMU's library names it nowhere. The input is
   amplitude 400 + 100 sin(0.1 i) before step i. Messages of the FMU go to standard error. The last line is
   "# seconds per step", the ones before are "state bits of the output, as hexadecimal". */

#include <dlfcn.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fmi2Functions.h"

static void logger(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    (void)environment;
    fprintf(stderr, "%s: status %d, %s: %s\n", instance, status, category ? category : "-", message);
}

static void *library;

static void *find(const char *name)
{
    void *function = dlsym(library, name);
    if (function == NULL) {
        fprintf(stderr, "%s\n", dlerror());
        exit(3);
    }
    return function;
}

static void check(fmi2Status status, const char *what)
{
    if (status != fmi2OK) {
        fprintf(stderr, "%s: status %d\n", what, status);
        exit(4);
    }
}

int main(int argc, char **argv)
{
    if (argc < 8) return 2;
    if (strcmp(argv[1], "-") != 0 && dlopen(argv[1], RTLD_NOW | RTLD_GLOBAL) == NULL) {
        fprintf(stderr, "%s\n", dlerror());
        return 3;
    }
    library = dlopen(argv[2], RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        fprintf(stderr, "%s\n", dlerror());
        return 3;
    }
    const long steps = strtol(argv[4], NULL, 10);
    const double step = strtod(argv[5], NULL);
    const fmi2ValueReference input = (fmi2ValueReference)strtoul(argv[6], NULL, 10);
    const fmi2ValueReference output = (fmi2ValueReference)strtoul(argv[7], NULL, 10);
    const int keep = argc > 8 && strcmp(argv[8], "keep") == 0;

    fmi2InstantiateTYPE *instantiate = (fmi2InstantiateTYPE *)find("fmi2Instantiate");
    fmi2SetRealTYPE *set = (fmi2SetRealTYPE *)find("fmi2SetReal");
    fmi2GetRealTYPE *get = (fmi2GetRealTYPE *)find("fmi2GetReal");
    fmi2DoStepTYPE *advance = (fmi2DoStepTYPE *)find("fmi2DoStep");
    fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};

    fmi2Component slave =
        instantiate("hosted by C", fmi2CoSimulation, "any", argv[3], &callbacks, fmi2False, fmi2False);
    if (slave == NULL) return 4;
    check(((fmi2SetupExperimentTYPE *)find("fmi2SetupExperiment"))(slave, fmi2False, 0, 0, fmi2False, 0), "setup");
    check(((fmi2EnterInitializationModeTYPE *)find("fmi2EnterInitializationMode"))(slave), "enter");
    check(((fmi2ExitInitializationModeTYPE *)find("fmi2ExitInitializationMode"))(slave), "exit");

    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (long i = 0; i < steps; i++) {
        double value = 400.0 + 100.0 * sin(0.1 * (double)i);
        check(set(slave, &input, 1, &value), "set");
        check(advance(slave, (double)i * step, step, fmi2True), "step");
        check(get(slave, &output, 1, &value), "get");
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        printf("%016" PRIx64 "\n", bits);
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    printf("# %g\n", ((double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec)) / (double)steps);
    if (!keep) {
        check(((fmi2TerminateTYPE *)find("fmi2Terminate"))(slave), "terminate");
        ((fmi2FreeInstanceTYPE *)find("fmi2FreeInstance"))(slave);
    }
    fflush(stdout);
    return 0;
}
