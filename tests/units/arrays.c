/* Arrays and odd names, FMI 3.0 alone: y = A u, doubled in mode 2. */
#define NAME "arrays"
#define TOKEN "{arrays}"
#define STATES 0
#define INDICATORS 0
enum { U, A = 10, Y = 20, MODE = 30, OFFSET, BIAS, STATE, DERIVATIVE = STATE, COUNT };
#include "unit.h"

static void defaults(Unit *u) { for (int i = 0; i < 6; i++) u->v[A + i] = i + 1; u->v[MODE] = 1; }
static int start(Unit *u) { (void)u; return OK; }
static int evaluate(Unit *u) {
    for (int i = 0; i < 2; i++) {
        u->v[Y + i] = u->v[OFFSET] + u->v[BIAS] + (strcmp(u->text, "negative") ? 0 : -1000);
        for (int k = 0; k < 3; k++) u->v[Y + i] += u->v[MODE] * u->v[A + 3 * i + k] * u->v[U + k];
    }
    return OK;
}
static void indicate(const Unit *u, double *z) { (void)u; (void)z; }
static int happen(Unit *u) { (void)u; return 0; }
static int step(Unit *u, double h) { (void)h; return evaluate(u); }
static int slopes(Unit *u, const uint32_t *unknowns, size_t n, uint32_t known, double *to) { (void)unknowns; (void)n; (void)known; (void)to; return say(u, ERROR, "no derivatives"); }
