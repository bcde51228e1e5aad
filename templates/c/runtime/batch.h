/* batch.h: models of many sets of parameters of a chain side by side. */

/* Models of up to NAME_WIDTH sets. Plain data, yours; only `build_batch` writes into it. It is read and written sooner
 * where it begins at a multiple of 64 bytes. */
struct name_batch {
    name_real series[NAME_SERIES][NAME_WIDTH];
    /* for `build_batch` alone: as many sets side by side as a vector holds */
    name_march_state work[NAME_WIDTH];
    name_march_tables tables[NAME_WIDTH];
    name_real inverse[NAME_ROW + 1];
    int since[NAME_FORCES + 1][2];
    /* of each set the estimate, and what `build` returns; of each window the degree, for all sets, and where its series
     * begin */
    name_real estimate[NAME_WIDTH];
    int status[NAME_WIDTH];
    int degree[NAME_WINDOWS];
    size_t place[NAME_WINDOWS];
};
