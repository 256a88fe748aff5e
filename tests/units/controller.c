/* A sampled PI controller of a pressure in bar, as a programmable controller runs it: one step, one scan. */
#define NAME "controller"
#define TOKEN "{controller}"
#define STATES 0
#define INDICATORS 0
enum { SET, MEASURED, ENABLE, KP, TI, U, SCANS, STATE, INTEGRAL = STATE, DERIVATIVE, COUNT };
#include "unit.h"

static void defaults(Unit *u) { u->v[KP] = 0.05; u->v[TI] = 0.2; u->v[ENABLE] = 1; }
static int start(Unit *u) { (void)u; return OK; }
static int evaluate(Unit *u) { (void)u; return OK; }
static void indicate(const Unit *u, double *z) { (void)u; (void)z; }
static int happen(Unit *u) { (void)u; return 0; }
static int step(Unit *u, double h) {
    double *v = u->v, e = v[SET] - v[MEASURED];
    v[SCANS]++;
    v[INTEGRAL] += h / v[TI] * e;
    v[U] = v[ENABLE] ? fmin(1, fmax(-1, v[KP] * (e + v[INTEGRAL]))) : 0;
    return OK;
}
static int slopes(Unit *u, const uint32_t *unknowns, size_t n, uint32_t known, double *to) { (void)unknowns; (void)n; (void)known; (void)to; return say(u, ERROR, "no derivatives"); }
