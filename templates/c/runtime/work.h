/* work.h: what a model of a chain needs while it is built. */

/* What is worked in while a model is built, and what nobody needs afterwards. */
struct name_work {
    name_march_state set;
    name_march_tables tables;
    name_real inverse[NAME_ROW + 1];
    int since[NAME_FORCES + 1][2];
};
