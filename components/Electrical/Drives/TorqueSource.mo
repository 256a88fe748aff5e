within Electrical.Drives;
model TorqueSource "Torque-controlled motor as a lag, with limited torque and ripple over the angle"
  Interfaces.RealInput T_ref(unit = "N.m") "Command of torque";
  Interfaces.RotationalFlange flange "Shaft";
  parameter SI.Time tau_i(min = 1e-6) = 0.5e-3 "Time constant of the current loop";
  parameter SI.Torque T_max(min = 1e-6) = 9.54 "Greatest torque";
  parameter SI.Torque T_cog(min = 0) = 0 "Amplitude of the cogging torque";
  parameter Integer h_c(min = 1) = 144 "Order of the cogging torque";
  SI.Torque T_e(start = 0, fixed = true) "Torque of the motor";
equation
  assert(tau_i > 0 and T_max > 0, "tau_i and T_max must be positive");
  tau_i*der(T_e) = min(max(T_ref, -T_max), T_max) - T_e;
  flange.tau = -T_e + T_cog*sin(h_c*flange.phi);
  annotation(Documentation(info = "<html><p><code>tau_i dT/dt = sat(T_ref) - T</code> and a cogging torque over the angle: the naive form of <code>ServoMotor</code>.</p></html>"));
end TorqueSource;
