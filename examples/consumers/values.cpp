// All outputs of building_m2 at tau = 2.5, and the largest strain at the foot, from C++.
#include "building_m2.h"

#include <algorithm>
#include <cstdio>
#include <vector>

int main()
{
    double out[BUILDING_M2_OUTPUTS];
    if (building_m2_eval(2.5, out) != 0) return 1;
    for (int k = 0; k < BUILDING_M2_OUTPUTS; ++k) std::printf("%s %.12g\n", building_m2_output_name[k], out[k]);

    const std::size_t count = 2001;
    std::vector<double> all(count * BUILDING_M2_OUTPUTS);
    if (building_m2_sample(0.0, BUILDING_M2_TAU_MAX / 2000.0, count, all.data()) != 0) return 1;
    std::printf("largest %.12g\n", *std::max_element(all.begin(), all.begin() + count));
}
