model Pollution "Chemistry of the air of the Netherlands: 25 reactions of 20 species"
  constant Real k[25] = {
    0.35, 0.266e2, 0.123e5, 0.86e-3, 0.82e-3, 0.15e5, 0.13e-3, 0.24e5, 0.165e5, 0.9e4, 0.22e-1, 0.12e5, 1.88,
    0.163e5, 0.48e7, 0.35e-3, 0.175e-1, 0.1e9, 0.444e12, 0.124e4, 2.1, 5.78, 0.474e-1, 0.178e4, 3.12} "Rates";
  Real y[20](
    start = {0, 0.2, 0, 0.04, 0, 0, 0.1, 0.3, 0.01, 0, 0, 0, 0, 0, 0, 0, 0.007, 0, 0, 0}, each fixed = true,
    nominal = {0.1, 0.1, 1e-8, 1e-2, 1e-6, 1e-6, 0.1, 0.1, 1e-2, 1e-7, 1e-7, 1e-2, 1e-3, 1e-4, 1e-2, 1e-16, 1e-2, 1e-4,
      1e-5, 1e-4}) "Concentrations in ppm";
protected
  Real r[25] "Reactions";
equation
  r[1] = k[1]*y[1];
  r[2] = k[2]*y[2]*y[4];
  r[3] = k[3]*y[5]*y[2];
  r[4] = k[4]*y[7];
  r[5] = k[5]*y[7];
  r[6] = k[6]*y[7]*y[6];
  r[7] = k[7]*y[9];
  r[8] = k[8]*y[9]*y[6];
  r[9] = k[9]*y[11]*y[2];
  r[10] = k[10]*y[11]*y[1];
  r[11] = k[11]*y[13];
  r[12] = k[12]*y[10]*y[2];
  r[13] = k[13]*y[14];
  r[14] = k[14]*y[1]*y[6];
  r[15] = k[15]*y[3];
  r[16] = k[16]*y[4];
  r[17] = k[17]*y[4];
  r[18] = k[18]*y[16];
  r[19] = k[19]*y[16];
  r[20] = k[20]*y[17]*y[6];
  r[21] = k[21]*y[19];
  r[22] = k[22]*y[19];
  r[23] = k[23]*y[1]*y[4];
  r[24] = k[24]*y[19]*y[1];
  r[25] = k[25]*y[20];
  der(y[1]) = -r[1] - r[10] - r[14] - r[23] - r[24] + r[2] + r[3] + r[9] + r[11] + r[12] + r[22] + r[25];
  der(y[2]) = -r[2] - r[3] - r[9] - r[12] + r[1] + r[21];
  der(y[3]) = -r[15] + r[1] + r[17] + r[19] + r[22];
  der(y[4]) = -r[2] - r[16] - r[17] - r[23] + r[15];
  der(y[5]) = -r[3] + 2*r[4] + r[6] + r[7] + r[13] + r[20];
  der(y[6]) = -r[6] - r[8] - r[14] - r[20] + r[3] + 2*r[18];
  der(y[7]) = -r[4] - r[5] - r[6] + r[13];
  der(y[8]) = r[4] + r[5] + r[6] + r[7];
  der(y[9]) = -r[7] - r[8];
  der(y[10]) = -r[12] + r[7] + r[9];
  der(y[11]) = -r[9] - r[10] + r[8] + r[11];
  der(y[12]) = r[9];
  der(y[13]) = -r[11] + r[10];
  der(y[14]) = -r[13] + r[12];
  der(y[15]) = r[14];
  der(y[16]) = -r[18] - r[19] + r[16];
  der(y[17]) = -r[20];
  der(y[18]) = r[20];
  der(y[19]) = -r[21] - r[22] - r[24] + r[23] + r[25];
  der(y[20]) = -r[25] + r[24];
  annotation(
    experiment(StartTime = 0, StopTime = 60, Interval = 0.12, Tolerance = 1e-6),
    Documentation(info = "<html><p>Time in minutes. Source: J. G. Verwer 1994; Test Set for IVP Solvers, problem POLLU, with the published values at 60.</p></html>"));
end Pollution;
