within ClosedCircuit;
model Load "Load machine: torque over speed and command"
  Interfaces.RotationalFlange flange "Shaft";
  Interfaces.RealInput u(unit = "V") "Command";
  parameter SI.Torque a_0 = 8 "Constant torque";
  parameter Real a_1(unit = "N.m/V") = 20 "Torque over command";
  parameter Real a_2(unit = "N.m.min/rev") = 0.03 "Torque over speed";
  parameter Real a_3(unit = "N.m.min/(rev.V)") = 0.006 "Torque over speed and command";
  parameter SI.RotationalDampingConstant B(min = 0) = 0.1 "Viscous friction";
  parameter SI.AngularVelocity w_s(min = 1e-3) = 1 "Width of the sign of speed";
  SI.AngularVelocity w(nominal = 100) "Speed";
  SI.Torque T_L(nominal = 100) "Torque of the load without friction";
protected
  Real N(unit = "rev/min") "Speed";
equation
  w = der(flange.phi);
  N = Modelica.Units.Conversions.to_rpm(w);
  T_L = (a_0 + a_1*u)*Smooth.sgn(w, w_s) + (a_2 + a_3*u)*N;
  flange.tau = T_L + B*w;
end Load;
