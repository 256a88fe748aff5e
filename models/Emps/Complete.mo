within Emps;
model Complete "The axis in its position loop, with dry friction and force offset"
  parameter SI.Mass M(min = 1, max = 1000, nominal = 100) = 95.1089 "Moving mass, motor included";
  parameter SI.TranslationalDampingConstant F_v(min = 0, max = 1e4, nominal = 200) = 203.5034 "Viscous friction";
  parameter SI.Force F_c(min = 0, max = 1e3, nominal = 20) = 20.3935 "Dry friction";
  parameter SI.Force F_0(min = -1e3, max = 1e3, nominal = 3) = -3.1648 "Force offset, against the motor";
  parameter SI.Velocity v_c(min = 1e-6, max = 1, nominal = 1e-3) = 5e-4 "Speed over which dry friction changes sign";
  parameter Real k_F(unit = "N/V", min = 0, nominal = 30) = 35.15065 "Force of the motor over control voltage";
  parameter SI.Position q_start(nominal = 0.1) = 0 "Position at the start";
  parameter SI.Velocity v_start(nominal = 0.1) = 0 "Velocity at the start";
  Interfaces.RealInput q_ref(unit = "m", nominal = 0.1) "Reference position";
  Interfaces.RealInput pulse(unit = "V", start = 0) "Voltage added to the controller's";
  Interfaces.RealOutput q(unit = "m", nominal = 0.1) "Position";
  Interfaces.RealOutput F(unit = "N", nominal = 100) "Force of the motor";
  Controller controller(q_start = q_start) "Position controller";
  Signal.Gain amplifier(k = k_F) "Force over voltage";
  Mechanical.Translational.Force motor "Motor";
  Mechanical.Translational.Mass carriage(m = M, s(start = q_start), v(start = v_start)) "Carriage";
  Mechanical.Translational.Damper viscous(d = F_v) "Viscous friction";
  Mechanical.Translational.Fixed frame "Frame";
  Mechanical.Translational.SmoothSupportFriction dry(f_c = F_c, v_c = v_c) "Dry friction";
  Mechanical.Translational.ConstantForce offset(f_constant = -F_0) "Force offset";
equation
  connect(q_ref, controller.q_ref);
  connect(pulse, controller.pulse);
  connect(q, controller.q);
  connect(controller.u, amplifier.u);
  connect(amplifier.y, F);
  connect(amplifier.y, motor.f);
  connect(motor.flange, carriage.flange_a);
  connect(carriage.flange_b, viscous.flange_a);
  connect(viscous.flange_b, frame.flange);
  q = carriage.s;
  connect(carriage.flange_b, dry.flange_a);
  connect(offset.flange, carriage.flange_a);
  annotation(
    experiment(StartTime = 0, StopTime = 24.84, Interval = 0.001, Tolerance = 1e-6),
    Documentation(info = "<html><p>As <code>Nominal</code>, with dry friction rounded over <code>v_c</code>, so that it can be linearised everywhere; <code>Axis</code> sticks exactly.</p></html>"));
end Complete;
