/* parameters.h: which sets of parameters are tried, of programs that take them at run time. */
#include "fuzz.h"

enum { COUNT = sizeof(name_parameters) / sizeof(name_real) };

/* Those of the scene, some of them changed a little, by powers of two, or to any number. */
static void some_parameters(told *t, name_parameters *set)
{
    name_real all[COUNT];
    memcpy(all, &name_defaults, sizeof all);
    for (int changes = choice(t, COUNT + 1); changes > 0; --changes) {
        const int which = choice(t, COUNT);
        switch (choice(t, 4)) {
        case 0:
            all[which] *= (name_real)1 + (name_real)choice(t, 256) / 256;
            break;
        case 1:
            all[which] *= power_of_two(choice(t, 64) - 32);
            break;
        case 2:
            all[which] = beside(all[choice(t, COUNT)], choice(t, 5) - 2);
            break;
        default:
            all[which] = number(t);
            break;
        }
    }
    memcpy(set, all, sizeof all);
}
