/* replay.c: each file given, once more; for compilers that have no fuzzer. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

int main(int count, char **paths)
{
    static uint8_t bytes[1 << 16];
    for (int k = 1; k < count; ++k) {
        FILE *const file = fopen(paths[k], "rb");
        if (!file) {
            return EXIT_FAILURE;
        }
        const size_t length = fread(bytes, 1, sizeof bytes, file);
        uint8_t *const given = (uint8_t *)malloc(length + (length == 0));
        fclose(file);
        if (!given) {
            return EXIT_FAILURE;
        }
        for (size_t j = 0; j < length; ++j) {
            given[j] = bytes[j];
        }
        fprintf(stderr, "%s\n", paths[k]);
        (void)LLVMFuzzerTestOneInput(given, length);
        free(given);
    }
    return EXIT_SUCCESS;
}
