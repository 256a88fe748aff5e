/* No continuous states: each tick, at known times or when `go` changes, takes the input. */
#define NAME "ticker"
#define TOKEN "{ticker}"
#define STATES 0
#define INDICATORS 0
enum { U, GO, PERIOD, GAIN, Y, TICKS, ON, THROUGH, STATE, DERIVATIVE = STATE, COUNT };
#include "unit.h"

static void defaults(Unit *u) { u->v[PERIOD] = 0.1; u->v[GAIN] = 2; }
static int start(Unit *u) { u->next = u->time + u->v[PERIOD]; return OK; }
static int evaluate(Unit *u) { u->v[THROUGH] = 10 * u->v[U] + u->time; return OK; }
static void indicate(const Unit *u, double *z) { (void)u; (void)z; }
static int happen(Unit *u) {
    if (u->time >= u->next - 1e-9) {
        u->v[Y] = u->v[GAIN] * u->v[U];
        u->v[TICKS]++;
        u->v[ON] = !u->v[ON];
        u->next += u->v[PERIOD];
    }
    if (u->v[GO]) u->v[TICKS] += 100;
    return 0;
}
static int step(Unit *u, double h) { u->time += h; happen(u); return OK; }
static int slopes(Unit *u, const uint32_t *unknowns, size_t n, uint32_t known, double *to) { (void)unknowns; (void)n; (void)known; (void)to; return say(u, ERROR, "no derivatives"); }
