/* What always holds of a node, whatever happened to it. */
#ifndef ODS_FUZZ_INVARIANTS_H
#define ODS_FUZZ_INVARIANTS_H

#include "rig.h"

/* After every turn: states, counts and deadlines. */
void invariants_check(const rig_t *rig, uint32_t now);

/* Now and then, as it walks the dictionary: every value lies where its rule allows, and the right PDOs are active. */
void invariants_check_values(const rig_t *rig);

#endif
