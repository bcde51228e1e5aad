/* tuned.c: a stream of waves that is given its parameters when it begins. What is refused gives nothing, and a stream that
 * begins anew is what it was when it was built. */
#include "parameters.h"
#include "steps.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    told t = {bytes, count};
    static name_state state, again;
    name_parameters set;
    some_parameters(&t, &set);
    memset(&state, 0xff, sizeof state);
    const int status = name_build(&state, &set);
    MUST(status >= 0 && status <= 2);
    MUST(all_finite((const name_real *)&set, COUNT) || status == 1);
    memcpy(&again, &state, sizeof state);
    name_init(&again);
    MUST(memcmp(&again, &state, sizeof state) == 0);
    go_on(&t, &state, status);
    return 0;
}
