/* A ball that bounces, and lies still once it is slow: an event by state that changes a state. */
#define NAME "ball"
#define TOKEN "{ball}"
#define STATES 2
#define INDICATORS 1
enum { G, E, BOUNCES, LIES, STATE, DERIVATIVE = STATE + 2, COUNT = DERIVATIVE + 2 };
#include "unit.h"

static void defaults(Unit *u) { u->v[G] = 9.81; u->v[E] = 0.7; }
static int start(Unit *u) { u->v[STATE] = 1; u->v[STATE + 1] = 0; return OK; }
static int evaluate(Unit *u) {
    u->v[DERIVATIVE] = u->v[LIES] ? 0 : u->v[STATE + 1];
    u->v[DERIVATIVE + 1] = u->v[LIES] ? 0 : -u->v[G];
    return OK;
}
static void indicate(const Unit *u, double *z) { z[0] = u->v[LIES] ? 1 : u->v[STATE]; }
static int happen(Unit *u) {
    if (u->v[LIES] || u->v[STATE] > 1e-6 || u->v[STATE + 1] >= 0) return 0;
    u->v[BOUNCES]++;
    u->v[STATE] = 0;
    u->v[STATE + 1] *= -u->v[E];
    if (u->v[STATE + 1] < 0.5) { u->v[LIES] = 1; u->v[STATE + 1] = 0; }
    return 1;
}
static int step(Unit *u, double h) {
    int n = 1 + (int)(h / 1e-6);
    for (int i = 0; i < n; i++) {
        evaluate(u);
        u->v[STATE] += h / n * (u->v[DERIVATIVE] + 0.5 * h / n * u->v[DERIVATIVE + 1]);
        u->v[STATE + 1] += h / n * u->v[DERIVATIVE + 1];
        if (u->v[STATE] < 0) happen(u);
    }
    return OK;
}
static int slopes(Unit *u, const uint32_t *unknowns, size_t n, uint32_t known, double *to) { (void)unknowns; (void)n; (void)known; (void)to; return say(u, ERROR, "no derivatives"); }
