/* Problems of models/stiff as one writes them by hand for SUNDIALS IDA, to compare steps and errors: Jacobians by IDA's own
   differences, dense or band, absolute tolerances those of the models (tolerance times nominal). IDA integrates index 1:
   constraints of the mechanical problems and the balances of the water tubes' nodes are differentiated by hand until they
   determine accelerations and pressures, and then drift. The two-bit adder is left out.
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

/* Mechanics with constraints: positions, velocities, accelerations, forces of the constraints. The force rows and the
   constraints, differentiated twice, determine the latter two. */
static void motion(int n, const double *y, const double *yp, double *r) {
    for (int i = 0; i < 2*n; i++) r[i] = yp[i] - y[n+i];
}
static double dot(int n, const double *a, const double *b) { double s = 0; for (int i = 0; i < n; i++) s += a[i]*b[i]; return s; }

static void car(double t, const double *y, const double *yp, double *r) {
    const double *v = y + 4, *a = y + 8, m = 5e-4, w = 10;
    double yb = 0.1*sin(w*t), ybp = w*0.1*cos(w*t), ybpp = -w*w*yb, xb = sqrt(1 - yb*yb), xbp = -yb*ybp/xb;
    double xbpp = -(ybp*ybp + yb*ybpp + xbp*xbp)/xb, l1 = y[12], l2 = y[13], dx = y[0] - y[2], dy = y[1] - y[3];
    double Ll = hypot(y[0], y[1]), Lr = hypot(y[2] - xb, y[3] - yb), fl = (0.5 - Ll)/Ll, fr = (0.5 - Lr)/Lr;
    motion(4, y, yp, r);
    r[8] = m*a[0] - (fl*y[0] + l1*xb + 2*l2*dx); r[9] = m*a[1] - (fl*y[1] + l1*yb + 2*l2*dy - m);
    r[10] = m*a[2] - (fr*(y[2] - xb) - 2*l2*dx); r[11] = m*a[3] - (fr*(y[3] - yb) - 2*l2*dy - m);
    r[12] = xbpp*y[0] + 2*xbp*v[0] + xb*a[0] + ybpp*y[1] + 2*ybp*v[1] + yb*a[1];
    r[13] = pow(v[0] - v[2], 2) + pow(v[1] - v[3], 2) + dx*(a[0] - a[2]) + dy*(a[1] - a[3]);
}
static void car_0(double *y, double *yp, double *size) {
    double y0[] = {0, 0.5, 1, 0.5, -0.5, 0, -0.5, 0, 0, -1, 0, -1, 0, 0};
    memcpy(y, y0, sizeof y0); size[12] = size[13] = 1e-3;
}
static void car_names(int i, char *s) {
    const char *n[] = {"x_l", "y_l", "x_r", "y_r", "v_xl", "v_yl", "v_xr", "v_yr", "a_xl", "a_yl", "a_xr", "a_yr", "lambda_1", "lambda_2"};
    strcpy(s, n[i]);
}

static void squeezer(double t, const double *y, const double *yp, double *r) {
    static const double m[] = {0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498};
    static const double I[] = {2.194e-6, 4.41e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5};
    const double xb = -0.03635, yb = 0.03273, xc = 0.014, yc = 0.072, d = 28e-3, da = 115e-4, e = 2e-2, em = e - 1421e-5, zf = 2e-2,
        fm = zf - 1421e-5, rr = 7e-3, ra = 92e-5, ss = 35e-3, sa = 1874e-5, sb = 1043e-5, sc = 18e-3, sd = 2e-2, zt = 4e-2,
        ta = 2308e-5, tb = 916e-5, u = 4e-2, ua = 1228e-5, ub = 449e-5;
    const double *w = y + 7, *a = y + 14, *L = y + 21;
    double be = y[0], th = y[1], ga = y[2], ph = y[3], de = y[4], om = y[5], ep = y[6], bt = be + th, pd = ph + de, oe = om + ep;
    double xd = sd*cos(ga) + sc*sin(ga) + xb, yd = sd*sin(ga) - sc*cos(ga) + yb, l = hypot(xd - xc, yd - yc);
    double force = -4530*(l - 7785e-5)/l, fx = force*(xd - xc), fy = force*(yd - yc), odd = L[0] + L[2] + L[4], even = L[1] + L[3] + L[5];
    double m12 = m[1]*(da*da - da*rr*cos(th)) + I[1], m45 = m[3]*(em*em + zt*em*sin(ph)) + I[3], m67 = m[5]*(fm*fm - u*fm*sin(om)) + I[5];
    motion(7, y, yp, r);
    r[14] = (m[0]*ra*ra + m[1]*(rr*rr - 2*da*rr*cos(th) + da*da) + I[0] + I[1])*a[0] + m12*a[1] - 33e-3
        + m[1]*da*rr*w[1]*(w[1] + 2*w[0])*sin(th) + (-rr*sin(be) + d*sin(bt))*odd + (rr*cos(be) - d*cos(bt))*even;
    r[15] = m12*a[0] + (m[1]*da*da + I[1])*a[1] - m[1]*da*rr*w[0]*w[0]*sin(th) + d*sin(bt)*odd - d*cos(bt)*even;
    r[16] = (m[2]*(sa*sa + sb*sb) + I[2])*a[2] - fx*(sc*cos(ga) - sd*sin(ga)) - fy*(sd*cos(ga) + sc*sin(ga))
        - ss*cos(ga)*L[0] - ss*sin(ga)*L[1];
    r[17] = (m[3]*em*em + I[3])*a[3] + m45*a[4] - m[3]*zt*em*w[4]*w[4]*cos(ph) - e*cos(pd)*L[2] - e*sin(pd)*L[3];
    r[18] = m45*a[3] + (m[3]*(zt*zt + 2*zt*em*sin(ph) + em*em) + m[4]*(ta*ta + tb*tb) + I[3] + I[4])*a[4]
        + m[3]*zt*em*w[3]*(w[3] + 2*w[4])*cos(ph) + (-e*cos(pd) + zt*sin(de))*L[2] + (-e*sin(pd) - zt*cos(de))*L[3];
    r[19] = (m[5]*fm*fm + I[5])*a[5] + m67*a[6] + m[5]*u*fm*w[6]*w[6]*cos(om) + zf*sin(oe)*L[4] - zf*cos(oe)*L[5];
    r[20] = m67*a[5] + (m[5]*(fm*fm - 2*u*fm*sin(om) + u*u) + m[6]*(ua*ua + ub*ub) + I[5] + I[6])*a[6]
        - m[5]*u*fm*w[5]*(w[5] + 2*w[6])*cos(om) + (zf*sin(oe) - u*cos(ep))*L[4] + (-zf*cos(oe) - u*sin(ep))*L[5];
    /* second derivatives of cosine and sine of the angles that stand in the constraints */
#define COS(x, v, a) (-sin(x)*(a) - cos(x)*(v)*(v))
#define SIN(x, v, a) (cos(x)*(a) - sin(x)*(v)*(v))
    double bt1 = w[0] + w[1], bt2 = a[0] + a[1], pd1 = w[3] + w[4], pd2 = a[3] + a[4], oe1 = w[5] + w[6], oe2 = a[5] + a[6];
    double x = rr*COS(be, w[0], a[0]) - d*COS(bt, bt1, bt2), z = rr*SIN(be, w[0], a[0]) - d*SIN(bt, bt1, bt2);
    r[21] = x - ss*SIN(ga, w[2], a[2]); r[22] = z + ss*COS(ga, w[2], a[2]);
    r[23] = x - e*SIN(pd, pd1, pd2) - zt*COS(de, w[4], a[4]); r[24] = z + e*COS(pd, pd1, pd2) - zt*SIN(de, w[4], a[4]);
    r[25] = x - zf*COS(oe, oe1, oe2) - u*SIN(ep, w[6], a[6]); r[26] = z - zf*SIN(oe, oe1, oe2) + u*COS(ep, w[6], a[6]);
}
static void squeezer_0(double *y, double *yp, double *size) {
    double y0[27] = {-0.0617138900142764496358948458001, 0, 0.455279819163070380255912382449, 0.222668390165885884674473185609,
        0.48736497954384255022559895353, -0.222668390165885884674473185609, 1.23054744454982119249735015568, 0, 0, 0, 0, 0, 0, 0,
        14222.4439199541138705911625887, -10666.8329399655854029433719415, 0, 0, 0, 0, 0, 98.5668703962410896057654982170,
        -6.12268834425566265503114393122};
    memcpy(y, y0, sizeof y0); fill(7, size + 7, 100); fill(7, size + 14, 1e4); fill(6, size + 21, 10);
}
static void squeezer_names(int i, char *s) {
    const char *n[] = {"beta", "theta", "gamma", "phi", "delta", "Omega", "epsilon"};
    if (i < 7) strcpy(s, n[i]); else sprintf(s, i < 14 ? "w[%d]" : i < 21 ? "a[%d]" : "lambda[%d]", i < 21 ? i%7 + 1 : i - 20);
}

/* phi_1, phi_2, x_3, q[4]; their velocities; their accelerations; lambda[3] */
static void crank(double t, const double *y, const double *yp, double *r) {
    const double pi = 3.1415927, l1 = 0.15, l2 = 0.3, m2 = 0.151104, m3 = 0.075552, J1 = 0.002727, J2 = 0.0045339259, b = 0.008,
        h = 0.008, rho = 7870, V = b*h*l2, k = 2e11*b*h/l2, *q = y + 3, *w = y + 7, *v = y + 10, *a = y + 14, *aq = y + 17, *L = y + 21;
    double mass = rho*V, bend = k*pow(pi, 4)*pow(h/l2, 2), Mq[] = {0.5*mass*q[0], 0.5*mass*q[1], mass*(8*q[2] + q[3]), mass*(q[2] + 2*q[3])};
    double Ma[] = {0.5*mass*aq[0], 0.5*mass*aq[1], mass*(8*aq[2] + aq[3]), mass*(aq[2] + 2*aq[3])};
    double Kq[] = {bend/24*q[0], bend*2/3*q[1], k*(16*q[2] - 8*q[3])/3, k*(7*q[3] - 8*q[2])/3};
    double p3 = 16/(pi*pi*pi), b3 = 8/(pi*pi*pi) - 1/pi;
    double Bv[] = {V*(-p3*v[2] + b3*v[3]), V*0.5/pi*v[3], V*p3*v[0], V*(-b3*v[0] - 0.5/pi*v[1])};
    double qB[] = {V*(p3*q[2] - b3*q[3]), -V*0.5/pi*q[3], -V*p3*q[0], V*(b3*q[0] + 0.5/pi*q[1])};
    double c1[] = {0, 0, V*2/3, V/6}, c2[] = {V*2/pi, 0, 0, 0}, c12[] = {0, 0, l2*V/3, l2*V/6}, c21[] = {l2*V/pi, -l2*V*0.5/pi, 0, 0};
    double s = sin(y[0] - y[1]), c = cos(y[0] - y[1]), along = l2 + q[3];
    double m12 = 0.5*l1*l2*m2*c + rho*l1*(s*dot(4, c2, q) + c*dot(4, c1, q)), row1 = 0, row2 = 0;
    for (int i = 0; i < 4; i++) { row1 += (c*c2[i] - s*c1[i])*aq[i]; row2 += (c21[i] + qB[i])*aq[i]; }
    motion(7, y, yp, r);
    r[14] = (J1 + m2*l1*l1)*a[0] + m12*a[1] + rho*l1*row1 - (-0.5*l1*l2*m2*w[1]*w[1]*s
        + rho*l1*w[1]*w[1]*(c*dot(4, c2, q) - s*dot(4, c1, q)) - 2*rho*l1*w[1]*(c*dot(4, c1, v) + s*dot(4, c2, v))
        - l1*cos(y[0])*L[0] - l1*sin(y[0])*L[1] - L[2]);
    r[15] = m12*a[0] + (J2 + dot(4, q, Mq) + 2*rho*dot(4, c12, q))*a[1] + rho*row2 - (0.5*l1*l2*m2*w[0]*w[0]*s
        + rho*l1*w[0]*w[0]*(s*dot(4, c1, q) - c*dot(4, c2, q)) - 2*rho*w[1]*dot(4, c12, v) - 2*w[1]*dot(4, v, Mq)
        - rho*dot(4, v, Bv) - along*(cos(y[1])*L[0] + sin(y[1])*L[1]));
    r[16] = m3*a[2] + L[1];
    for (int i = 0; i < 4; i++)
        r[17+i] = rho*l1*(c*c2[i] - s*c1[i])*a[0] + rho*(c21[i] + qB[i])*a[1] + Ma[i]
            - (w[1]*w[1]*Mq[i] + rho*(w[1]*w[1]*c12[i] + l1*w[0]*w[0]*(c*c1[i] + s*c2[i]) + 2*w[1]*Bv[i]) - Kq[i]
            + (i == 3 ? cos(y[1])*L[1] - sin(y[1])*L[0] : 0));
    r[21] = l1*SIN(y[0], w[0], a[0]) + aq[3]*sin(y[1]) + 2*v[3]*cos(y[1])*w[1] + along*SIN(y[1], w[1], a[1]);
    r[22] = a[2] - (l1*COS(y[0], w[0], a[0]) + aq[3]*cos(y[1]) - 2*v[3]*sin(y[1])*w[1] + along*COS(y[1], w[1], a[1]));
    r[23] = a[0];
}
/* accelerations and forces are found by IDA */
static void crank_0(double *y, double *yp, double *size) {
    double y0[] = {0, 0, 0.450016933, 0, 0, 1.03339863e-5, 1.69327969e-5, 150, -74.9957670, -2.68938672e-6, 0.444896112581599,
        4.63433931923867e-3, -1.78591076000055e-6, -2.68938671997904e-6};
    double s[] = {1, 1, 1, 1e-4, 1e-5, 1e-6, 1e-6, 1, 100, 10, 0.1, 1e-2, 1e-3, 1e-3, 1, 1e4, 1, 1, 1, 1, 1, 100, 100, 100};
    y0[2] = 0.15 + 0.3 + y0[6]; y0[8] = -150*0.15/(0.3 + y0[6]); y0[9] = y0[13];
    memcpy(y, y0, sizeof y0); memcpy(size, s, sizeof s);
}
static void crank_names(int i, char *s) {
    const char *n[] = {"phi_1", "phi_2", "x_3"};
    if (i < 3) strcpy(s, n[i]);
    else sprintf(s, i < 7 ? "q[%d]" : i < 10 ? "w[%d]" : i < 14 ? "v[%d]" : i < 21 ? "a[%d]" : "lambda[%d]",
        i < 7 ? i - 2 : i < 10 ? i - 6 : i < 14 ? i - 9 : i < 21 ? i - 13 : i - 20);
}

/* phi[18], lambda[18], p[13]: flows of the tubes, their friction, pressures; the balances of nodes without a tank,
   differentiated once, determine their pressures */
static void water(double t, const double *y, const double *yp, double *r) {
    static const int from[] = {1, 2, 2, 3, 3, 4, 5, 6, 7, 7, 8, 8, 9, 11, 11, 12, 12, 13}, to[] = {2, 3, 6, 4, 5, 5, 10, 5, 4, 8, 5, 10, 8, 9, 12, 7, 8, 11};
    const double nu = 1.31e-6, rho = 1e3, g = 9.8, crit = 2.3e3, L = 1e3, k = 2e-4, d = 1, A = PI/4, b = 200, *lam = y + 18, *p = y + 36;
    double h = t/3600, x = exp(-h) - 1, net[13] = {0}, rate[13] = {0}, slope = -sin(x)*exp(-h)/3600;
    net[0] = (1 - cos(x))/200; rate[0] = slope/200; net[12] = (1 - cos(x))/80; rate[12] = slope/80;
    net[9] = -h*h*(3*h*h - 92*h + 720)/1e6; rate[9] = -h*(12*h*h - 276*h + 1440)/1e6/3600;
    for (int i = 0; i < 18; i++) {
        double R = fabs(y[i]*d/(nu*A)), f = p[from[i]-1] - p[to[i]-1];
        f -= R > crit ? lam[i]*rho*L*y[i]*y[i]/(A*A*d) : 32*nu*rho*L*y[i]/(A*d*d);
        r[i] = rho*L/A*yp[i] - f;
        r[18+i] = 1/sqrt(lam[i]) - 1.74 + 2*log10(2*k/d + 18.7/((R > crit ? R : crit)*sqrt(lam[i])));
        net[to[i]-1] += y[i]; net[from[i]-1] -= y[i];
        rate[to[i]-1] += f*A/(rho*L); rate[from[i]-1] -= f*A/(rho*L);
    }
    for (int n = 0; n < 13; n++) r[36+n] = n == 4 || n == 7 ? b/(rho*g)*yp[36+n] - net[n] : rate[n];
}
static void water_0(double *y, double *yp, double *size) {
    fill(18, y + 18, 0.047519404529185289807); fill(13, y + 36, 109800);
    fill(18, size, 1e-3); fill(18, size + 18, 0.05); fill(13, size + 36, 1e5);
}
static void water_names(int i, char *s) { sprintf(s, i < 18 ? "phi[%d]" : i < 36 ? "lambda[%d]" : "p[%d]", i < 36 ? i%18 + 1 : i - 35); }

/* On a torus: rows 1, N, 2, N - 1, ... one after the other, so that neighbours are at most two rows apart. */
enum { SIDE = 32 };
static int place(int i) { return i < SIDE/2 ? 2*i : 2*(SIDE - 1 - i) + 1; }
static int cell(int i, int j) { return 2*(SIDE*place((i + SIDE)%SIDE) + (j + SIDE)%SIDE); }
static void torus(double t, const double *y, const double *yp, double *r) {
    for (int i = 0; i < SIDE; i++) for (int j = 0; j < SIDE; j++) {
        int c = cell(i, j), n[] = {cell(i + 1, j), cell(i - 1, j), cell(i, j + 1), cell(i, j - 1)};
        double u = y[c], v = y[c+1], su = -4*u, sv = -4*v, d = 0.1*SIDE*SIDE, x = (double)i/SIDE - 0.3, z = (double)j/SIDE - 0.6;
        for (int k = 0; k < 4; k++) { su += y[n[k]]; sv += y[n[k]+1]; }
        r[c] = yp[c] - (1 + u*u*v - 4.4*u + (x*x + z*z <= 0.01 && t > 1.1 ? 5 : 0) + d*su);
        r[c+1] = yp[c+1] - (3.4*u - u*u*v + d*sv);
    }
}
static void torus_0(double *y, double *yp, double *size) {
    for (int i = 0; i < SIDE; i++) for (int j = 0; j < SIDE; j++) {
        double x = (double)i/SIDE, z = (double)j/SIDE;
        y[cell(i, j)] = 22*z*pow(1 - z, 1.5); y[cell(i, j)+1] = 27*x*pow(1 - x, 1.5);
    }
}
static void torus_names(int k, char *s) {
    int row = k/2/SIDE, i = row%2 ? SIDE - 1 - row/2 : row/2;
    sprintf(s, "%c[%d,%d]", k%2 ? 'v' : 'u', i + 1, k/2%SIDE + 1);
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
    {"CarAxis", 14, 0, 8, 3, 0, car_0, car, car_names},
    {"Squeezer", 27, 0, 14, 0.03, 0, squeezer_0, squeezer, squeezer_names},
    {"SliderCrank", 24, 0, 14, 0.1, 0, crank_0, crank, crank_names},
    {"WaterTubes", 49, 0, -2, 61200, 0, water_0, water, water_names},
    {"Brusselator2D", 2*SIDE*SIDE, 4*SIDE, 2*SIDE*SIDE, 11.5, 1.1, torus_0, torus, torus_names},
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
    IDASetLinearSolver(m, s, J); IDASetMaxNumSteps(m, 3000000);
    if (p->algebraic >= 0 && p->algebraic < p->n) { /* finds what the states determine */
        N_Vector states = N_VNew_Serial(p->n, c);
        for (int i = 0; i < p->n; i++) N_VGetArrayPointer(states)[i] = i < p->algebraic;
        IDASetId(m, states);
        if (IDACalcIC(m, IDA_YA_YDP_INIT, 1e-3*p->end) < 0) return 1;
        IDAGetConsistentIC(m, y, yp);
    }
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
