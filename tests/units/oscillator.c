/* Mass, spring and damper: m der(v) = f - d v - c x; x0 in mm. */
#define NAME "oscillator"
#define TOKEN "{oscillator}"
#define STATES 2
#define INDICATORS 0
enum { F, M, C, D, X0, POWER, STATE, DERIVATIVE = STATE + 2, COUNT = DERIVATIVE + 2 };
#include "unit.h"

static void defaults(Unit *u) { u->v[M] = 2; u->v[C] = 200; u->v[D] = 3; u->v[X0] = 100; }
static int start(Unit *u) { u->v[STATE] = 1e-3 * u->v[X0]; u->v[STATE + 1] = 0; return OK; }
static int evaluate(Unit *u) {
    double *v = u->v, x = v[STATE], w = v[STATE + 1];
    v[DERIVATIVE] = w;
    v[DERIVATIVE + 1] = (v[F] - v[D] * w - v[C] * x) / v[M];
    v[POWER] = v[F] * w;
    return OK;
}
static void indicate(const Unit *u, double *z) { (void)u; (void)z; }
static int happen(Unit *u) { (void)u; return 0; }
static int step(Unit *u, double h) {
    int n = 1 + (int)(h / 1e-5);
    for (int i = 0; i < n; i++) { /* symplectic, first order at 10 microseconds */
        evaluate(u);
        u->v[STATE + 1] += h / n * u->v[DERIVATIVE + 1];
        u->v[STATE] += h / n * u->v[STATE + 1];
    }
    return OK;
}
static int slopes(Unit *u, const uint32_t *unknowns, size_t n, uint32_t known, double *to) {
    double *v = u->v, w = v[STATE + 1];
    for (size_t i = 0; i < n; i++) {
        double x = 0;
        if (unknowns[i] == DERIVATIVE) x = known == STATE + 1;
        else if (unknowns[i] == DERIVATIVE + 1) x = (known == F ? 1 : known == STATE ? -v[C] : known == STATE + 1 ? -v[D] : 0) / v[M];
        else if (unknowns[i] == POWER) x = known == F ? w : known == STATE + 1 ? v[F] : 0;
        else x = unknowns[i] == known;
        to[i] = x;
    }
    return OK;
}
