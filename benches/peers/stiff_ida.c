/* Stiff problems as an expert writes them on SUNDIALS IDA: exact dense Jacobian, y' explicit, absolute tolerances as
   given. usage: stiff_ida PROBLEM TOLERANCE REPEATS; prints {"solve_s", "steps", "y"} of the fastest run. */
#include <idas/idas.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <time.h>

typedef void (*rhs_t)(const double *y, double *f);
typedef void (*jac_t)(const double *y, SUNMatrix J);
typedef struct { const char *name; int n; double end, y0[8], size[8]; rhs_t rhs; jac_t jac; } problem_t;
#define E(i, j) SM_ELEMENT_D(J, i, j)

static void robertson(const double *y, double *f) {
    f[0] = -0.04*y[0] + 1e4*y[1]*y[2]; f[2] = 3e7*y[1]*y[1]; f[1] = -f[0] - f[2];
}
static void robertson_j(const double *y, SUNMatrix J) {
    E(0,0) = -0.04; E(0,1) = 1e4*y[2]; E(0,2) = 1e4*y[1];
    E(2,1) = 6e7*y[1];
    for (int j = 0; j < 3; j++) E(1,j) = -E(0,j) - E(2,j);
}
static void hires(const double *y, double *f) {
    double r = 280*y[5]*y[7];
    f[0] = -1.71*y[0] + 0.43*y[1] + 8.32*y[2] + 0.0007; f[1] = 1.71*y[0] - 8.75*y[1];
    f[2] = -10.03*y[2] + 0.43*y[3] + 0.035*y[4]; f[3] = 8.32*y[1] + 1.71*y[2] - 1.12*y[3];
    f[4] = -1.745*y[4] + 0.43*y[5] + 0.43*y[6]; f[5] = -r + 0.69*y[3] + 1.71*y[4] - 0.43*y[5] + 0.69*y[6];
    f[6] = r - 1.81*y[6]; f[7] = -f[6];
}
static void hires_j(const double *y, SUNMatrix J) {
    E(0,0) = -1.71; E(0,1) = 0.43; E(0,2) = 8.32; E(1,0) = 1.71; E(1,1) = -8.75;
    E(2,2) = -10.03; E(2,3) = 0.43; E(2,4) = 0.035; E(3,1) = 8.32; E(3,2) = 1.71; E(3,3) = -1.12;
    E(4,4) = -1.745; E(4,5) = 0.43; E(4,6) = 0.43;
    E(5,3) = 0.69; E(5,4) = 1.71; E(5,5) = -280*y[7] - 0.43; E(5,6) = 0.69; E(5,7) = -280*y[5];
    E(6,5) = 280*y[7]; E(6,6) = -1.81; E(6,7) = 280*y[5];
    for (int j = 0; j < 8; j++) E(7,j) = -E(6,j);
}
static void vdp(const double *y, double *f) { f[0] = y[1]; f[1] = ((1 - y[0]*y[0])*y[1] - y[0])*1e6; }
static void vdp_j(const double *y, SUNMatrix J) {
    E(0,1) = 1; E(1,0) = (-2*y[0]*y[1] - 1)*1e6; E(1,1) = (1 - y[0]*y[0])*1e6;
}
static problem_t problems[] = {
    {"Robertson", 3, 40, {1}, {1, 1e-6, 1}, robertson, robertson_j},
    {"HiRes", 8, 321.8122, {1, 0, 0, 0, 0, 0, 0, 0.0057}, {1e-3, 1e-4, 1e-4, 1e-3, 1e-3, 1e-2, 1e-3, 1e-3}, hires, hires_j},
    {"VanDerPol", 2, 2, {2, 0}, {1, 1}, vdp, vdp_j},
};

static int residual(double t, N_Vector y, N_Vector yp, N_Vector r, void *user) {
    problem_t *p = user; double f[8], *a = N_VGetArrayPointer(yp), *out = N_VGetArrayPointer(r);
    p->rhs(N_VGetArrayPointer(y), f);
    for (int i = 0; i < p->n; i++) out[i] = a[i] - f[i];
    return 0;
}
static int jacobian(double t, double cj, N_Vector y, N_Vector yp, N_Vector r, SUNMatrix J, void *user, N_Vector a,
                    N_Vector b, N_Vector c) {
    problem_t *p = user;
    p->jac(N_VGetArrayPointer(y), J);
    for (int j = 0; j < p->n; j++) for (int i = 0; i < p->n; i++) E(i,j) = (i == j ? cj : 0) - E(i,j);
    return 0;
}
static double now(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t); return t.tv_sec + 1e-9*t.tv_nsec; }

int main(int argc, char **argv) {
    if (argc < 4) return 2;
    problem_t *p = NULL;
    for (size_t i = 0; i < sizeof problems/sizeof *problems; i++) if (!strcmp(problems[i].name, argv[1])) p = problems + i;
    if (!p) return 2;
    double tol = atof(argv[2]), best = 1e99, last[8]; long steps = 0;
    for (int k = 0; k < atoi(argv[3]); k++) {
        double begun = now(), t;
        SUNContext c; SUNContext_Create(SUN_COMM_NULL, &c);
        N_Vector y = N_VNew_Serial(p->n, c), yp = N_VNew_Serial(p->n, c), atol = N_VNew_Serial(p->n, c);
        for (int i = 0; i < p->n; i++) { N_VGetArrayPointer(y)[i] = p->y0[i]; N_VGetArrayPointer(atol)[i] = tol*p->size[i]; }
        p->rhs(N_VGetArrayPointer(y), N_VGetArrayPointer(yp));
        void *m = IDACreate(c);
        IDAInit(m, residual, 0, y, yp); IDASVtolerances(m, tol, atol); IDASetUserData(m, p);
        SUNMatrix J = SUNDenseMatrix(p->n, p->n, c); SUNLinearSolver s = SUNLinSol_Dense(y, J, c);
        IDASetLinearSolver(m, s, J); IDASetJacFn(m, jacobian); IDASetMaxNumSteps(m, 10000000); IDASetStopTime(m, p->end);
        if (IDASolve(m, p->end, &t, y, yp, IDA_NORMAL) < 0) return 1;
        IDAGetNumSteps(m, &steps);
        memcpy(last, N_VGetArrayPointer(y), sizeof(double)*p->n);
        IDAFree(&m); SUNLinSolFree(s); SUNMatDestroy(J); N_VDestroy(y); N_VDestroy(yp); N_VDestroy(atol); SUNContext_Free(&c);
        double took = now() - begun; if (took < best) best = took;
    }
    printf("{\"solve_s\": %.9g, \"steps\": %ld, \"y\": [", best, steps);
    for (int i = 0; i < p->n; i++) printf("%s%.17g", i ? ", " : "", last[i]);
    puts("]}");
    return 0;
}
