/* Arrays of FMI 3.0: a value reference stands for all elements, of which each has a place in the memory. What takes
   references below, and says what is wrong with them, knows elements only. */
#include "fmi3.h"

#include <stdlib.h>

bool elements_of(Elements *some, const Instance *instance, const char *call, const fmi3ValueReference vr[],
                 size_t count, size_t values, bool first)
{
    size_t total = 0, filled = 0;
    *some = (Elements){vr, vr || values > count ? values : count, NULL, 0};
    for (size_t i = 0; vr && i < count; i++) {
        const Variable *variable = instance_variable(vr[i]);
        if (variable && !variable->elements) variable = NULL;
        if (!variable) {
            instance_say(instance, ERROR, "there is no value reference %u", (unsigned)vr[i]);
            return false;
        }
        total += variable->elements;
    }
    if (vr && total != values && first && values == count) {
        some->missing = total - values;
        return true;
    }
    if (vr && total != values) {
        instance_say(instance, ERROR, "%s: %zu values for %zu variables, which have %zu elements", call, values, count,
                     total);
        return false;
    }
    if (!vr || total == count) return true; /* no arrays */
    some->made = malloc(total * sizeof *some->made);
    if (!some->made) {
        instance_say(instance, ERROR, "out of memory");
        return false;
    }
    for (size_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < instance_variable(vr[i])->elements; j++) some->made[filled++] = vr[i] + j;
    some->references = some->made;
    return true;
}
