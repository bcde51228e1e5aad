/* ports.h: the tables of joints and of the ends of rods at them, their ports, of all marches. */

/* joints: where their points, states and ports start in the next tables, and the force on each point, -1 for none */
extern const int first_point[];
extern const int first_state[];
extern const int first_port[];
extern const int force_on[];
/* ports: the point of the joint, how fast an end moves with it, the track that arrives and the one that it sends */
extern const int point_of[];
extern const real ratio[];
extern const int arrive[];
extern const int send[];
