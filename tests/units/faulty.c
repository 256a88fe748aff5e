/* A unit that fails as `fault` says: 1 at the end of initialization, 2 from 0.5 s on, 3 with no number from 0.5 s on, 4 it
   discards steps from 0.5 s on, 5 it warns. */
#define NAME "faulty"
#define TOKEN "{faulty}"
#define STATES 1
#define INDICATORS 0
enum { FAULT, Y, STATE, DERIVATIVE, COUNT };
#include "unit.h"

static void defaults(Unit *u) { (void)u; }
static int start(Unit *u) {
    if (u->v[FAULT] == 1 && u->mode != INITIALIZATION) return say(u, ERROR, "no pressure at %s", "port B");
    return OK;
}
static int late(Unit *u, double t) {
    if (u->v[FAULT] == 2 && t > 0.5) return say(u, ERROR, "the map of the valve ends at %g s", 0.5);
    if (u->v[FAULT] == 4 && t > 0.5) return say(u, DISCARD, "too far");
    if (u->v[FAULT] == 5) return say(u, WARNING, "warm");
    return OK;
}
static int evaluate(Unit *u) {
    u->v[DERIVATIVE] = 1;
    u->v[Y] = u->v[FAULT] == 3 && u->time > 0.5 ? NAN : u->time;
    return late(u, u->time);
}
static void indicate(const Unit *u, double *z) { (void)u; (void)z; }
static int happen(Unit *u) { (void)u; return 0; }
static int step(Unit *u, double h) { u->v[STATE] += h; return late(u, u->time + h); }
static int slopes(Unit *u, const uint32_t *unknowns, size_t n, uint32_t known, double *to) { (void)unknowns; (void)n; (void)known; (void)to; return say(u, ERROR, "no derivatives"); }
