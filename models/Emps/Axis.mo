within Emps;
model Axis "The axis driven by a force"
  parameter SI.Mass M(min = 1, max = 1000, nominal = 100) = 95.1089 "Moving mass, motor included";
  parameter SI.TranslationalDampingConstant F_v(min = 0, max = 1e4, nominal = 200) = 203.5034 "Viscous friction";
  parameter SI.Force F_c(min = 0, max = 1e3, nominal = 20) = 20.3935 "Dry friction";
  parameter SI.Force F_0(min = -1e3, max = 1e3, nominal = 3) = -3.1648 "Force offset, against the motor";
  parameter SI.Position q_start = 0 "Position at the start";
  parameter SI.Velocity v_start = 0 "Velocity at the start";
  Interfaces.RealInput F(unit = "N", nominal = 100) "Force of the motor";
  Interfaces.RealOutput q(unit = "m", nominal = 0.1) "Position";
  Interfaces.RealOutput v(unit = "m/s", nominal = 0.1) "Velocity";
  Mechanical.Translational.Force motor "Motor";
  Mechanical.Translational.ConstantForce offset(f_constant = -F_0) "Force offset";
  Mechanical.Translational.Mass carriage(m = M, s(start = q_start), v(start = v_start)) "Carriage";
  Mechanical.Translational.SupportFriction friction(f_c = F_c, d = F_v) "Friction";
equation
  connect(F, motor.f);
  connect(motor.flange, carriage.flange_a);
  connect(offset.flange, carriage.flange_a);
  connect(carriage.flange_b, friction.flange_a);
  q = carriage.s;
  v = carriage.v;
  annotation(
    experiment(StartTime = 0, StopTime = 24.84, Interval = 0.001, Tolerance = 1e-6),
    Documentation(info = "<html><p><code>M dv/dt = F - F_v v - F_c sign(v) - F_0</code>, dry friction with exact sticking. Values published with the data. Driven by the recorded force alone the position drifts away; compare velocities over short windows, or use <code>ClosedLoop</code>.</p></html>"));
end Axis;
