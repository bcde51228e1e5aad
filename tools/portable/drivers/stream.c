/* stream.c: a stream of waves or of modes from the start on. */
#include "steps.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    told t = {bytes, count};
    static name_state state;
    name_init(&state);
    go_on(&t, &state, 0);
    return 0;
}
