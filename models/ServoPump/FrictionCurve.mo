within ServoPump;
model FrictionCurve "Friction torque of motor and pump over speed, without load (paper's Fig. 12)"
  parameter Real N_end(unit = "rev/min", min = 1, max = 3000) = 1500 "Speed at the end of the ramp";
  parameter Real theta_oil(unit = "degC", min = 0, max = 90) = 35 "Temperature of the oil";
  inner Oil.ServoPumpOil oil(T_0 = Modelica.Units.Conversions.from_degC(theta_oil)) "Oil";
  Signal.Ramp speed(offset = 0.1, height = Modelica.Units.Conversions.from_rpm(N_end) - 0.1, duration = 10) "Speed";
  Mechanical.Rotational.Speed motor "Shaft, its speed held exactly";
  Mechanical.Rotational.BearingFriction friction(tau_c = 0.01, tau_s = 0.05, w_s = 20, d = 0.2e-4) "Dry friction of seal and bearings";
  BenchPump pump(compression = false, dry(z(start = 1.98e-4))) "Pump, its bristles wound up at the start: it turns";
  Hydraulic.Tank tank "Tank, at both ports";
  Real N(unit = "rev/min", nominal = 1e3) "Speed";
  SI.Torque T_f(nominal = 0.1) "Friction torque of both";
equation
  connect(speed.y, motor.w_ref);
  connect(motor.flange, friction.flange_a);
  connect(friction.flange_b, pump.flange);
  connect(pump.port_a, tank.port);
  connect(pump.port_b, tank.port);
  N = Modelica.Units.Conversions.to_rpm(pump.w);
  T_f = friction.tau + pump.T_loss;
  annotation(
    experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6),
    Documentation(info = "<html><p>A Stribeck curve: 0.10 Nm at breakaway, falling to 0.06 Nm of Coulomb friction over 20 rad/s, then rising with 1.2e-4 Nm.s/rad. The paper prints the shape without numbers; these are assumed.</p></html>"));
end FrictionCurve;
