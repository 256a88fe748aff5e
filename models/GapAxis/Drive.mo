within GapAxis;
model Drive "Speed-controlled motor: PI controller with clipped current, lag of the current, torque constant"
  parameter Real K_p(unit = "A.s/rad") = 0.30 "Gain of the speed controller";
  parameter Real K_i(unit = "A/rad") = 6 "Integral gain";
  parameter SI.Current i_max(min = 0) = 40 "Limit of the current";
  parameter SI.Time tau_i(min = 1e-6) = 1e-3 "Time constant of the current";
  parameter SI.ElectricalTorqueConstant K_t(min = 0) = 1.2 "Torque constant";
  Interfaces.RealInput u(unit = "rad/s") "Command of speed";
  Interfaces.RotationalFlange flange "Shaft";
  SI.AngularVelocity w(nominal = 10) "Speed";
  SI.AngularVelocity e "Control error";
  SI.Current z(start = 0, fixed = true) "Integral part";
  SI.Current i(start = 0, fixed = true) "Current";
  SI.Current i_ref "Command of current";
equation
  assert(i_max > 0 and tau_i > 0, "i_max and tau_i must be positive");
  w = der(flange.phi);
  e = u - w;
  i_ref = smooth(0, min(max(K_p*e + z, -i_max), i_max));
  der(z) = K_i*e;
  tau_i*der(i) = i_ref - i;
  flange.tau = -K_t*i;
end Drive;
