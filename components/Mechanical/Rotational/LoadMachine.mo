within Mechanical.Rotational;
model LoadMachine "Load machine: torque over command and speed as a polynomial, with a lag"
  Interfaces.RotationalFlange flange "Shaft";
  Interfaces.RealInput u "Command";
  parameter SI.Torque c_00 = 0 "Constant torque against the motion";
  parameter SI.Torque c_10 = 1 "Torque over command";
  parameter Real c_01(unit = "N.m.s/rad") = 0 "Torque over speed";
  parameter Real c_11(unit = "N.m.s/rad") = 0 "Torque over command and speed";
  parameter SI.Torque c_20 = 0 "Torque over the square of the command";
  parameter Real c_02(unit = "N.m.s2/rad2") = 0 "Torque over the square of speed";
  parameter SI.Time tau_u(min = 1e-6, max = 100, nominal = 0.05) = 0.05 "Time constant of the command";
  parameter SI.AngularVelocity w_s(min = 1e-6, max = 100, nominal = 1) = 1 "Width of the sign of speed";
  parameter Real u_start = 0 "Command at the start, behind the lag";
  Real u_f(start = u_start, fixed = true) "Command behind the lag";
  SI.AngularVelocity w(nominal = 100) "Speed";
  SI.Torque T_L(nominal = 10) "Load torque, against the motion";
equation
  assert(tau_u > 0 and w_s > 0, "tau_u and w_s must be positive");
  tau_u*der(u_f) = u - u_f;
  w = der(flange.phi);
  T_L = (c_00 + c_10*u_f + c_20*u_f^2)*Smooth.sgn(w, w_s) + (c_01 + c_11*u_f)*w + c_02*w*sqrt(w^2 + 1e-6);
  flange.tau = T_L;
  annotation(Documentation(info = "<html><p><code>T_L = (c_00 + c_10 u + c_20 u^2) sign(w) + (c_01 + c_11 u) w + c_02 w |w|</code>, the sign rounded over <code>w_s</code>: a brake, passive as long as the brackets stay positive. A pump against a proportional relief valve, an eddy current brake and a fan have this form.
The command is dimensionless or in the unit of its source. Polynomials hold within the range that they were fitted to.</p></html>"));
end LoadMachine;
