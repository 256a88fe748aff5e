/* A functional mock-up unit around a few functions of a model, for FMI 2.0 (-DFMI=2) or FMI 3.0 (-DFMI=3). What a model
   defines before it includes this: NAME, TOKEN, COUNT (variables, by their value references), STATES, INDICATORS; the rest
   below. Calls in the wrong mode are errors, so that tests see them. */

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OK = 0, WARNING = 1, DISCARD = 2, ERROR = 3 };
enum { INSTANTIATED, INITIALIZATION, EVENT, CONTINUOUS, STEP };

typedef struct Unit {
    double v[COUNT];
    double time, next;
    int mode, co_simulation;
    void *environment;
    void (*logger)();
    char text[64];
} Unit;

/* The model. `evaluate` finds what follows from time, states and inputs; `happen` does what an event does and says whether
   states have changed; `step` is one step of Co-Simulation; the first derivative lies at DERIVATIVE, states before it at STATE. */
static void defaults(Unit *u);
static int start(Unit *u);
static int evaluate(Unit *u);
static void indicate(const Unit *u, double *z);
static int happen(Unit *u);
static int step(Unit *u, double h);
static int slopes(Unit *u, const uint32_t *unknowns, size_t n, uint32_t known, double *to);

static int say(Unit *u, int status, const char *format, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (!u->logger) return status;
#if FMI == 2
    ((void (*)(void *, const char *, int, const char *, const char *, ...))u->logger)(u->environment, NAME, status, "", "%s", text);
#else
    ((void (*)(void *, int, const char *, const char *))u->logger)(u->environment, status, "", text);
#endif
    return status;
}

static int in(Unit *u, int a, int b, int c, const char *what) {
    if (u->mode == a || u->mode == b || u->mode == c) return 1;
    say(u, ERROR, "%s is not allowed in mode %d", what, u->mode);
    return 0;
}

static Unit *make(const char *token, void *environment, void (*logger)(), int co_simulation) {
    Unit *u = calloc(1, sizeof *u);
    u->environment = environment;
    u->logger = logger;
    u->co_simulation = co_simulation;
    u->next = INFINITY;
#ifdef REFUSES
    say(u, ERROR, "the licence for %s has expired", NAME);
    free(u);
    return NULL;
#endif
    if (strcmp(token, TOKEN)) {
        say(u, ERROR, "the token is %s", token);
        free(u);
        return NULL;
    }
    defaults(u);
    return u;
}

static int initialize(Unit *u, double t) {
    if (!in(u, INSTANTIATED, -1, -1, "initialization")) return ERROR;
    u->time = t;
    u->mode = INITIALIZATION;
    return start(u);
}

static int started(Unit *u) {
    if (!in(u, INITIALIZATION, -1, -1, "the end of initialization")) return ERROR;
    u->mode = u->co_simulation ? STEP : EVENT;
    return start(u);
}

static int reset(Unit *u) {
    Unit fresh = {.environment = u->environment, .logger = u->logger, .co_simulation = u->co_simulation, .next = INFINITY};
    *u = fresh;
    defaults(u);
    return OK;
}

static int one_step(Unit *u, double t, double h) {
    if (!in(u, STEP, -1, -1, "a step")) return ERROR;
    if (fabs(t - u->time) > 1e-9) return say(u, ERROR, "a step from %g s, and the unit stands at %g s", t, u->time);
    int status = step(u, h);
    u->time = t + h;
    return status > WARNING ? status : evaluate(u);
}

static int get(Unit *u, const uint32_t *r, size_t n, double *to) {
    if (u->mode == INSTANTIATED) return say(u, ERROR, "nothing is known before initialization");
    int status = evaluate(u);
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= COUNT) return say(u, ERROR, "there is no variable %u", r[i]);
        to[i] = u->v[r[i]];
    }
    return status;
}

static int set(Unit *u, const uint32_t *r, size_t n, const double *from, int discrete) {
    if (discrete && u->mode == CONTINUOUS) return say(u, ERROR, "a discrete value cannot change between events");
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= COUNT) return say(u, ERROR, "there is no variable %u", r[i]);
        u->v[r[i]] = from[i];
    }
    return u->mode == INITIALIZATION ? start(u) : OK;
}

static int states(Unit *u, const double *from, double *to, size_t n) {
    if (n != STATES) return say(u, ERROR, "%zu states instead of %d", n, STATES);
    if (from && !in(u, CONTINUOUS, -1, -1, "setting states")) return ERROR;
    for (size_t i = 0; i < n; i++) {
        if (from) u->v[STATE + i] = from[i];
        else to[i] = u->v[STATE + i];
    }
    return OK;
}

static int derivatives(Unit *u, double *to, size_t n) {
    int status = evaluate(u);
    for (size_t i = 0; i < n; i++) to[i] = u->v[DERIVATIVE + i];
    return status;
}

static int indicators(Unit *u, double *to, size_t n) {
    int status = evaluate(u);
    if (n) indicate(u, to);
    return status;
}

#if FMI == 2
typedef struct { void (*logger)(); void *(*allocate)(size_t, size_t); void (*release)(void *); void *finished; void *environment; } Callbacks;
typedef struct { int again, terminate, nominals, values, defined; double next; } Info;

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *place, const Callbacks *c, int visible, int log) {
    (void)name; (void)place; (void)visible; (void)log;
    return make(guid, c->environment, c->logger, type == 1);
}
void fmi2FreeInstance(Unit *u) { free(u); }
int fmi2SetupExperiment(Unit *u, int d, double tolerance, double t, int s, double stop) {
    (void)d; (void)tolerance; (void)s; (void)stop;
    u->time = t;
    return OK;
}
int fmi2EnterInitializationMode(Unit *u) { return initialize(u, u->time); }
int fmi2ExitInitializationMode(Unit *u) { return started(u); }
int fmi2Reset(Unit *u) { return reset(u); }
int fmi2Terminate(Unit *u) { (void)u; return OK; }
int fmi2GetReal(Unit *u, const uint32_t *r, size_t n, double *to) { return get(u, r, n, to); }
int fmi2SetReal(Unit *u, const uint32_t *r, size_t n, const double *from) { return set(u, r, n, from, 0); }
int fmi2GetInteger(Unit *u, const uint32_t *r, size_t n, int *to) {
    double x = 0;
    int status = OK;
    for (size_t i = 0; i < n && status <= WARNING; i++) { status = get(u, r + i, 1, &x); to[i] = (int)x; }
    return status;
}
int fmi2SetInteger(Unit *u, const uint32_t *r, size_t n, const int *from) {
    int status = OK;
    for (size_t i = 0; i < n && status <= WARNING; i++) { double x = from[i]; status = set(u, r + i, 1, &x, 1); }
    return status;
}
int fmi2GetBoolean(Unit *u, const uint32_t *r, size_t n, int *to) { return fmi2GetInteger(u, r, n, to); }
int fmi2SetBoolean(Unit *u, const uint32_t *r, size_t n, const int *from) { return fmi2SetInteger(u, r, n, from); }
int fmi2SetString(Unit *u, const uint32_t *r, size_t n, const char *const *from) { (void)r; (void)n; snprintf(u->text, sizeof u->text, "%s", from[0]); return OK; }
#ifndef NO_STEP
int fmi2DoStep(Unit *u, double t, double h, int never) { (void)never; return one_step(u, t, h); }
#endif
int fmi2EnterEventMode(Unit *u) { if (!in(u, CONTINUOUS, -1, -1, "an event")) return ERROR; u->mode = EVENT; return OK; }
int fmi2EnterContinuousTimeMode(Unit *u) { if (!in(u, EVENT, -1, -1, "the end of an event")) return ERROR; u->mode = CONTINUOUS; return OK; }
int fmi2CompletedIntegratorStep(Unit *u, int never, int *event, int *stop) { (void)u; (void)never; *event = *stop = 0; return OK; }
int fmi2NewDiscreteStates(Unit *u, Info *info) {
    if (!in(u, EVENT, -1, -1, "an event iteration")) return ERROR;
    evaluate(u);
    Info found = {0, 0, 0, happen(u), isfinite(u->next), u->next};
    *info = found;
    return OK;
}
int fmi2SetTime(Unit *u, double t) { if (!in(u, CONTINUOUS, EVENT, -1, "setting time")) return ERROR; u->time = t; return OK; }
int fmi2SetContinuousStates(Unit *u, const double *x, size_t n) { return states(u, x, NULL, n); }
int fmi2GetContinuousStates(Unit *u, double *x, size_t n) { return states(u, NULL, x, n); }
int fmi2GetDerivatives(Unit *u, double *x, size_t n) { return derivatives(u, x, n); }
int fmi2GetEventIndicators(Unit *u, double *z, size_t n) { return indicators(u, z, n); }
int fmi2GetDirectionalDerivative(Unit *u, const uint32_t *unknowns, size_t n, const uint32_t *known, size_t k, const double *seed, double *to) {
    (void)k; (void)seed;
    return slopes(u, unknowns, n, known[0], to);
}
#else
void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *place, bool visible, bool log, void *environment, void (*logger)()) {
    (void)name; (void)place; (void)visible; (void)log;
    return make(token, environment, logger, 0);
}
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *place, bool visible, bool log, bool events, bool early, const uint32_t *r, size_t n, void *environment, void (*logger)(), void *update) {
    (void)name; (void)place; (void)visible; (void)log; (void)events; (void)early; (void)r; (void)n; (void)update;
    return make(token, environment, logger, 1);
}
void fmi3FreeInstance(Unit *u) { free(u); }
int fmi3EnterInitializationMode(Unit *u, bool d, double tolerance, double t, bool s, double stop) { (void)d; (void)tolerance; (void)s; (void)stop; return initialize(u, t); }
int fmi3ExitInitializationMode(Unit *u) { return started(u); }
int fmi3Reset(Unit *u) { return reset(u); }
int fmi3Terminate(Unit *u) { (void)u; return OK; }
/* a variable of several values has as many references behind its own */
int fmi3GetFloat64(Unit *u, const uint32_t *r, size_t n, double *to, size_t values) {
    int status = OK;
    for (size_t i = 0; i < values && status <= WARNING; i++) { uint32_t at = n == 1 ? r[0] + (uint32_t)i : r[i]; status = get(u, &at, 1, to + i); }
    return status;
}
int fmi3SetFloat64(Unit *u, const uint32_t *r, size_t n, const double *from, size_t values) {
    int status = OK;
    for (size_t i = 0; i < values && status <= WARNING; i++) { uint32_t at = n == 1 ? r[0] + (uint32_t)i : r[i]; status = set(u, &at, 1, from + i, 0); }
    return status;
}
#define TYPED(T, type) \
    int fmi3Get##T(Unit *u, const uint32_t *r, size_t n, type *to, size_t values) { double x = 0; int s = get(u, r, 1, &x); (void)n; (void)values; *to = (type)x; return s; } \
    int fmi3Set##T(Unit *u, const uint32_t *r, size_t n, const type *from, size_t values) { double x = (double)*from; (void)n; (void)values; return set(u, r, 1, &x, 1); }
TYPED(Int32, int32_t)
TYPED(Int64, int64_t)
TYPED(UInt8, uint8_t)
TYPED(Boolean, bool)
int fmi3SetString(Unit *u, const uint32_t *r, size_t n, const char *const *from, size_t values) { (void)r; (void)n; (void)values; snprintf(u->text, sizeof u->text, "%s", from[0]); return OK; }
#ifndef NO_STEP
int fmi3DoStep(Unit *u, double t, double h, bool never, bool *event, bool *stop, bool *early, double *last) {
    (void)never;
    *event = *stop = *early = false;
    *last = t + h;
    return one_step(u, t, h);
}
#endif
int fmi3EnterEventMode(Unit *u) { if (!in(u, CONTINUOUS, -1, -1, "an event")) return ERROR; u->mode = EVENT; return OK; }
int fmi3EnterContinuousTimeMode(Unit *u) { if (!in(u, EVENT, -1, -1, "the end of an event")) return ERROR; u->mode = CONTINUOUS; return OK; }
int fmi3CompletedIntegratorStep(Unit *u, bool never, bool *event, bool *stop) { (void)u; (void)never; *event = *stop = false; return OK; }
int fmi3UpdateDiscreteStates(Unit *u, bool *again, bool *stop, bool *nominals, bool *values, bool *defined, double *next) {
    if (!in(u, EVENT, -1, -1, "an event iteration")) return ERROR;
    evaluate(u);
    *again = *stop = *nominals = false;
    *values = happen(u);
    *defined = isfinite(u->next);
    *next = u->next;
    return OK;
}
int fmi3SetTime(Unit *u, double t) { if (!in(u, CONTINUOUS, EVENT, -1, "setting time")) return ERROR; u->time = t; return OK; }
int fmi3SetContinuousStates(Unit *u, const double *x, size_t n) { return states(u, x, NULL, n); }
int fmi3GetContinuousStates(Unit *u, double *x, size_t n) { return states(u, NULL, x, n); }
int fmi3GetContinuousStateDerivatives(Unit *u, double *x, size_t n) { return derivatives(u, x, n); }
int fmi3GetEventIndicators(Unit *u, double *z, size_t n) { return indicators(u, z, n); }
int fmi3GetDirectionalDerivative(Unit *u, const uint32_t *unknowns, size_t n, const uint32_t *known, size_t k, const double *seed, size_t s, double *to, size_t m) {
    (void)k; (void)seed; (void)s; (void)m;
    return slopes(u, unknowns, n, known[0], to);
}
#endif
