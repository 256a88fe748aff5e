/* Problems of models/stiff as one writes them by hand for SUNDIALS IDA, to compare steps and errors: Jacobians by IDA's own
   differences, dense or band, absolute tolerances those of the models (tolerance times nominal). The mechanical problems
   (index 3) and those of several hundred states in a plane or in gates are left out: IDA integrates index 1.
   usage: stiff_set PROBLEM TOLERANCE; prints {"steps", "residuals", "values"}. */
#include <idas/idas.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>

#define PI 3.14159265358979323846
typedef void (*start_t)(double *y, double *yp, double *size);
typedef void (*residual_t)(double t, const double *y, const double *yp, double *r);
typedef void (*name_t)(int i, char *out);
/* band: half-bandwidth, 0 for dense; algebraic: unknowns from this one on; jump: a time at which the equations change */
typedef struct { const char *name; int n, band, algebraic; double end, jump; start_t start; residual_t residual; name_t names; } problem_t;

static void rates(int n, const double *f, const double *yp, double *r) { for (int i = 0; i < n; i++) r[i] = yp[i] - f[i]; }
static void fill(int n, double *a, double v) { for (int i = 0; i < n; i++) a[i] = v; }
static void underscored(int i, char *s) { sprintf(s, "y_%d", i + 1); }
static void indexed(int i, char *s) { sprintf(s, "y[%d]", i + 1); }

static void robertson(double t, const double *y, const double *yp, double *r) {
    double a = 0.04*y[0], b = 1e4*y[1]*y[2], c = 3e7*y[1]*y[1], f[3] = {b - a, a - b - c, c};
    rates(3, f, yp, r);
}
static void robertson_0(double *y, double *yp, double *size) { y[0] = 1; size[0] = 1e-6; size[1] = 1e-12; }

static void hires(double t, const double *y, const double *yp, double *r) {
    double q = 280*y[5]*y[7], f[8] = {-1.71*y[0] + 0.43*y[1] + 8.32*y[2] + 0.0007, 1.71*y[0] - 8.75*y[1],
        -10.03*y[2] + 0.43*y[3] + 0.035*y[4], 8.32*y[1] + 1.71*y[2] - 1.12*y[3], -1.745*y[4] + 0.43*y[5] + 0.43*y[6],
        -q + 0.69*y[3] + 1.71*y[4] - 0.43*y[5] + 0.69*y[6], q - 1.81*y[6], 1.81*y[6] - q};
    rates(8, f, yp, r);
}
static void hires_0(double *y, double *yp, double *size) {
    double s[] = {1e-3, 1e-4, 1e-4, 1e-3, 1e-3, 1e-2, 1e-3, 1e-3};
    y[0] = 1; y[7] = 0.0057; memcpy(size, s, sizeof s);
}

static void vdp(double t, const double *y, const double *yp, double *r) {
    double f[2] = {y[1], ((1 - y[0]*y[0])*y[1] - y[0])*1e6};
    rates(2, f, yp, r);
}
static void vdp_0(double *y, double *yp, double *size) { y[0] = 2; }

static void pollution(double t, const double *x, const double *yp, double *res) {
    static const double k[] = {0, 0.35, 0.266e2, 0.123e5, 0.86e-3, 0.82e-3, 0.15e5, 0.13e-3, 0.24e5, 0.165e5, 0.9e4, 0.22e-1,
        0.12e5, 1.88, 0.163e5, 0.48e7, 0.35e-3, 0.175e-1, 0.1e9, 0.444e12, 0.124e4, 2.1, 5.78, 0.474e-1, 0.178e4, 3.12};
    const double *y = x - 1;
    double r[26] = {0, y[1], y[2]*y[4], y[5]*y[2], y[7], y[7], y[7]*y[6], y[9], y[9]*y[6], y[11]*y[2], y[11]*y[1], y[13],
        y[10]*y[2], y[14], y[1]*y[6], y[3], y[4], y[4], y[16], y[16], y[17]*y[6], y[19], y[19], y[1]*y[4], y[19]*y[1], y[20]};
    for (int i = 1; i < 26; i++) r[i] *= k[i];
    double f[20] = {-r[1] - r[10] - r[14] - r[23] - r[24] + r[2] + r[3] + r[9] + r[11] + r[12] + r[22] + r[25],
        -r[2] - r[3] - r[9] - r[12] + r[1] + r[21], -r[15] + r[1] + r[17] + r[19] + r[22], -r[2] - r[16] - r[17] - r[23] + r[15],
        -r[3] + 2*r[4] + r[6] + r[7] + r[13] + r[20], -r[6] - r[8] - r[14] - r[20] + r[3] + 2*r[18], -r[4] - r[5] - r[6] + r[13],
        r[4] + r[5] + r[6] + r[7], -r[7] - r[8], -r[12] + r[7] + r[9], -r[9] - r[10] + r[8] + r[11], r[9], -r[11] + r[10],
        -r[13] + r[12], r[14], -r[18] - r[19] + r[16], -r[20], r[20], -r[21] - r[22] - r[24] + r[23] + r[25], -r[25] + r[24]};
    rates(20, f, yp, res);
}
static void pollution_0(double *y, double *yp, double *size) {
    double s[] = {0.1, 0.1, 1e-8, 1e-2, 1e-6, 1e-6, 0.1, 0.1, 1e-2, 1e-7, 1e-7, 1e-2, 1e-3, 1e-4, 1e-2, 1e-16, 1e-2, 1e-4, 1e-5, 1e-4};
    memcpy(size, s, sizeof s);
    y[1] = 0.2; y[3] = 0.04; y[6] = 0.1; y[7] = 0.3; y[8] = 0.01; y[16] = 0.007;
}

/* y_1, y_2, y_4; the third species is the difference of the second and fourth */
static void e5(double t, const double *y, const double *yp, double *r) {
    double third = y[1] - y[2], a = 7.89e-10*y[0], b = 1.1e7*y[0]*third, c = 1.13e9*y[1]*third;
    double f[3] = {-a - b, a - c, b - 1.13e3*y[2]};
    rates(3, f, yp, r);
}
static void e5_0(double *y, double *yp, double *size) { y[0] = 1.76e-3; fill(3, size, 1e-20); }
static void e5_names(int i, char *s) { sprintf(s, "y_%d", i == 2 ? 4 : i + 1); }

static void ring(double t, const double *y, const double *yp, double *r) {
    const double *U = y - 1, *I = y + 6;
    double U1 = 0.5*sin(2e3*PI*t), U2 = 2*sin(2e4*PI*t), q[4];
    double u[4] = {U[3] - U[5] - U[7] - U2, -U[4] + U[6] - U[7] - U2, U[4] + U[5] + U[7] + U2, -U[3] - U[6] + U[7] + U2};
    for (int k = 0; k < 4; k++) q[k] = 40.67286402e-9*(exp(17.7493332*u[k]) - 1);
    double f[15] = {(I[1] - 0.5*I[3] + 0.5*I[4] + I[7] - U[1]/25e3)/1.6e-8, (I[2] - 0.5*I[5] + 0.5*I[6] + I[8] - U[2]/25e3)/1.6e-8,
        (I[3] - q[0] + q[3])/2e-12, (-I[4] + q[1] - q[2])/2e-12, (I[5] + q[0] - q[2])/2e-12, (-I[6] - q[1] + q[3])/2e-12,
        (-U[7]/50 + q[0] + q[1] - q[2] - q[3])/1e-8, -U[1]/4.45, -U[2]/4.45, (0.5*U[1] - U[3] - 17.3*I[3])/5e-4,
        (-0.5*U[1] + U[4] - 17.3*I[4])/5e-4, (0.5*U[2] - U[5] - 17.3*I[5])/5e-4, (-0.5*U[2] + U[6] - 17.3*I[6])/5e-4,
        (-U[1] + U1 - 86.3*I[7])/2e-3, (-U[2] - 636.3*I[8])/2e-3};
    rates(15, f, yp, r);
}
static void ring_0(double *y, double *yp, double *size) {
    double s[] = {1e-6, 1e-7, 1e-3, 1e-3, 1e-3, 1e-3, 1e-4, 1e-4};
    fill(7, size, 0.1); memcpy(size + 7, s, sizeof s);
}
static void ring_names(int i, char *s) { sprintf(s, i < 7 ? "U[%d]" : "I[%d]", i < 7 ? i + 1 : i - 6); }

static void akzo(double t, const double *y, const double *yp, double *r) {
    double root = sqrt(y[1]), a = 18.7*pow(y[0], 4)*root, b = 0.58*y[2]*y[3], c = 0.58/34.4*y[0]*y[4], d = 0.09*y[0]*y[3]*y[3],
           e = 0.42*y[5]*y[5]*root, in = 3.3*(0.9/737 - y[1]);
    double f[5] = {-2*a + b - c - d, -0.5*a - d - 0.5*e + in, a - b + c, -b + c - 2*d, b - c + e};
    rates(5, f, yp, r); r[5] = 115.83*y[0]*y[3] - y[5];
}
static void akzo_0(double *y, double *yp, double *size) {
    double y0[] = {0.444, 0.00123, 0, 0.007, 0, 115.83*0.444*0.007}, s[] = {1, 1e-3, 1, 1e-3, 1e-2, 1e-2};
    memcpy(y, y0, sizeof y0); memcpy(size, s, sizeof s);
}

static void transistor(double t, const double *y, const double *yp, double *r) {
    double g1 = 1e-6*(exp((y[1] - y[2])/0.026) - 1), g2 = 1e-6*(exp((y[4] - y[5])/0.026) - 1), R = 9000;
    double i1 = 1e-6*(yp[0] - yp[1]), i3 = 3e-6*(yp[3] - yp[4]), i5 = 5e-6*(yp[6] - yp[7]);
    r[0] = i1 - (0.1*sin(200*PI*t) - y[0])/1000; r[1] = i1 - (2*y[1] - 6)/R - 0.01*g1; r[2] = 2e-6*yp[2] - g1 + y[2]/R;
    r[3] = i3 - (6 - y[3])/R + 0.99*g1; r[4] = i3 - (2*y[4] - 6)/R - 0.01*g2; r[5] = 4e-6*yp[5] - g2 + y[5]/R;
    r[6] = i5 - (6 - y[6])/R + 0.99*g2; r[7] = i5 - y[7]/R;
}
/* consistent derivatives: the sums of two equations are constraints, whose rates determine the common rate of a pair */
static void transistor_0(double *y, double *yp, double *size) {
    double y0[] = {0, 3, 3, 6, 3, 3, 6, 0}, R = 9000, s = 1e-6/0.026;
    memcpy(y, y0, sizeof y0);
    yp[2] = -3/R/2e-6; yp[5] = -3/R/4e-6;
    yp[0] = yp[1] = (0.1*200*PI/1000 + 0.01*s*yp[2])/(1.0/1000 + 2/R + 0.01*s);
    double g1 = s*(yp[1] - yp[2]);
    yp[3] = yp[4] = (-0.99*g1 + 0.01*s*yp[5])/(3/R + 0.01*s);
    yp[6] = yp[7] = -R*0.99*s*(yp[4] - yp[5])/2;
}

enum { MEDICAL = 200, LINE = 500 };
static void medical(double t, const double *y, const double *yp, double *r) {
    double d = 1.0/MEDICAL, phi = t <= 5 ? 2 : 0;
    for (int j = 1; j <= MEDICAL; j++) {
        double u = y[2*j-2], v = y[2*j-1], left = j > 1 ? y[2*j-4] : phi, right = j < MEDICAL ? y[2*j] : u, z = j*d - 1;
        r[2*j-2] = yp[2*j-2] - (2*z*z*z/16*(right - left)/(2*d) + z*z*z*z/16*(left - 2*u + right)/(d*d) - 100*u*v);
        r[2*j-1] = yp[2*j-1] + 100*u*v;
    }
}
static void medical_0(double *y, double *yp, double *size) {
    for (int j = 0; j < MEDICAL; j++) { y[2*j+1] = 1; size[2*j] = 1e-4; size[2*j+1] = 1e-3; }
}
static void pairs(int i, char *s) { sprintf(s, "%c[%d]", i%2 ? 'v' : 'u', i/2 + 1); }

static void brusselator(double t, const double *y, const double *yp, double *r) {
    double d = (LINE + 1.0)*(LINE + 1.0)/50;
    for (int i = 0; i < LINE; i++) {
        double u = y[2*i], v = y[2*i+1], q = u*u*v;
        r[2*i] = yp[2*i] - (1 + q - 4*u + d*((i ? y[2*i-2] : 1) - 2*u + (i < LINE - 1 ? y[2*i+2] : 1)));
        r[2*i+1] = yp[2*i+1] - (3*u - q + d*((i ? y[2*i-1] : 3) - 2*v + (i < LINE - 1 ? y[2*i+3] : 3)));
    }
}
static void brusselator_0(double *y, double *yp, double *size) {
    for (int i = 0; i < LINE; i++) { y[2*i] = 1 + sin(2*PI*(i + 1)/(LINE + 1)); y[2*i+1] = 3; }
}

static problem_t problems[] = {
    {"Robertson", 3, 0, 3, 1e11, 0, robertson_0, robertson, underscored},
    {"HiRes", 8, 0, 8, 321.8122, 0, hires_0, hires, indexed},
    {"VanDerPol", 2, 0, 2, 2, 0, vdp_0, vdp, underscored},
    {"Pollution", 20, 0, 20, 60, 0, pollution_0, pollution, indexed},
    {"E5", 3, 0, 3, 1e13, 0, e5_0, e5, e5_names},
    {"RingModulator", 15, 0, 15, 1e-3, 0, ring_0, ring, ring_names},
    {"AkzoNobel", 6, 0, 5, 180, 0, akzo_0, akzo, underscored},
    {"TransistorAmplifier", 8, 0, -1, 0.2, 0, transistor_0, transistor, indexed},
    {"MedicalAkzo", 2*MEDICAL, 2, 2*MEDICAL, 20, 5, medical_0, medical, pairs},
    {"Brusselator", 2*LINE, 2, 2*LINE, 10, 0, brusselator_0, brusselator, pairs},
};

static int residual(double t, N_Vector y, N_Vector yp, N_Vector r, void *p) {
    ((problem_t *)p)->residual(t, N_VGetArrayPointer(y), N_VGetArrayPointer(yp), N_VGetArrayPointer(r));
    return 0;
}

/* Derivatives of the states, from the residual at derivatives of zero; algebraic unknowns begin without one. */
static void begin(problem_t *p, double t, double *y, double *yp) {
    if (p->algebraic < 0) return;
    double *r = calloc(p->n, sizeof *r);
    fill(p->n, yp, 0); p->residual(t, y, yp, r);
    for (int i = 0; i < p->algebraic; i++) yp[i] = -r[i];
    free(r);
}

int main(int argc, char **argv) {
    problem_t *p = NULL;
    for (size_t i = 0; argc > 2 && i < sizeof problems/sizeof *problems; i++) if (!strcmp(problems[i].name, argv[1])) p = problems + i;
    if (!p) return 2;
    double tolerance = atof(argv[2]), t = 0;
    SUNContext c; SUNContext_Create(SUN_COMM_NULL, &c);
    N_Vector y = N_VNew_Serial(p->n, c), yp = N_VNew_Serial(p->n, c), atol = N_VNew_Serial(p->n, c);
    N_VConst(0, y); N_VConst(0, yp); N_VConst(1, atol);
    p->start(N_VGetArrayPointer(y), N_VGetArrayPointer(yp), N_VGetArrayPointer(atol));
    begin(p, 0, N_VGetArrayPointer(y), N_VGetArrayPointer(yp));
    N_VScale(tolerance, atol, atol);
    void *m = IDACreate(c);
    IDAInit(m, residual, 0, y, yp); IDASVtolerances(m, tolerance, atol); IDASetUserData(m, p);
    SUNMatrix J = p->band ? SUNBandMatrix(p->n, p->band, p->band, c) : SUNDenseMatrix(p->n, p->n, c);
    SUNLinearSolver s = p->band ? SUNLinSol_Band(y, J, c) : SUNLinSol_Dense(y, J, c);
    IDASetLinearSolver(m, s, J); IDASetMaxNumSteps(m, 100000000);
    long steps = 0, residuals = 0, more, evaluated, differences;
    for (int leg = p->jump > 0 ? 0 : 1; leg < 2; leg++) {
        double to = leg ? p->end : p->jump;
        if (leg && p->jump > 0) { begin(p, nextafter(t, to), N_VGetArrayPointer(y), N_VGetArrayPointer(yp)); IDAReInit(m, nextafter(t, to), y, yp); }
        IDASetStopTime(m, to);
        if (IDASolve(m, to, &t, y, yp, IDA_NORMAL) < 0) return 1;
        IDAGetNumSteps(m, &more); IDAGetNumResEvals(m, &evaluated); IDAGetNumLinResEvals(m, &differences);
        steps += more; residuals += evaluated;
    }
    printf("{\"steps\": %ld, \"residuals\": %ld, \"values\": {", steps, residuals);
    for (int i = 0; i < p->n; i++) {
        char name[32];
        p->names(i, name);
        printf("%s\"%s\": %.17g", i ? ", " : "", name, N_VGetArrayPointer(y)[i]);
    }
    puts("}}");
    return 0;
}
