/* The steps of an FMU of FMI 3 as a program, which is linked with all of it: reads times, sizes and inputs, each with
   three derivatives, and writes the memory after each step. */
#include <stdio.h>

#include "fmi3.h"

int main(void)
{
    enum { GIVEN = 4 * INPUTS };
    double row[2 + GIVEN];
    fmi3ValueReference vr[GIVEN + 1];
    fmi3Boolean event, terminate, early;
    fmi3Float64 reached;
    fmi3Instance handle =
        fmi3InstantiateCoSimulation("one", TOKEN, "", false, false, false, false, NULL, 0, NULL, NULL, NULL);
    for (int i = 0; i < GIVEN; i++) vr[i] = INPUTS_AT + (unsigned)i;
    if (!handle || fmi3EnterInitializationMode(handle, false, 0.0, 0.0, false, 0.0)) return 1;
    if (fmi3ExitInitializationMode(handle)) return 1;
    while (fread(row, sizeof row, 1, stdin) == 1) {
        if (fmi3SetFloat64(handle, vr, GIVEN, row + 2, GIVEN)) return 1;
        if (fmi3DoStep(handle, row[0], row[1], false, &event, &terminate, &early, &reached)) return 1;
        instance_ready(INSTANCE, VARIABLES);
        fwrite(INSTANCE->now.data, sizeof(double), SIZE, stdout);
    }
    fmi3FreeInstance(handle);
    return 0;
}
