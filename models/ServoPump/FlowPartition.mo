within ServoPump;
model FlowPartition "Limits of the dead, load and saturation zones of the flow over pressure (paper's section 4)"
  extends SpeedLimits;
  parameter SI.Pressure p_load(min = 1e5, max = 25e6, nominal = 1e7) = 21e6 "Load pressure p_A - p_B at the end";
  parameter Real theta_oil(unit = "degC", min = 0, max = 90) = 35 "Temperature of the oil";
  inner Oil.ServoPumpOil oil(T_0 = Modelica.Units.Conversions.from_degC(theta_oil)) "Oil";
  Signal.Ramp pressure(offset = 1e5, height = p_load - 1e5, duration = 1) "Course of the load pressure";
  Hydraulic.PressureSource side_B(p = p_low) "Low side";
  Hydraulic.PressureSource side_A(useInput = true) "High side";
  Mechanical.Rotational.Speed motor "Speed at which the pump delivers nothing: the end of its dead zone";
  Real N_d(unit = "rev/min", nominal = 10) "End of the dead zone: the pump just covers its leakage";
  SI.VolumeFlowRate Q_s(nominal = 1e-5) "Flow at the begin of the saturation zone";
  SI.Volume slope(nominal = 1e-6, displayUnit = "ml") "Flow over speed in the load zone, per revolution";
protected
  SI.AngularVelocity w_d(nominal = 1) "Speed at the end of the dead zone";
equation
  connect(side_B.port, pump.port_b);
  connect(side_A.port, pump.port_a);
  side_A.p_in = p_low + pressure.y;
  dp = pressure.y;
  connect(motor.flange, pump.flange);
  motor.w_ref = w_d;
  pump.Q_A = 0;
  N_d = Modelica.Units.Conversions.to_rpm(w_d);
  Q_s = (pump.V - pump.sigma)*(N_s - N_d)/60;
  slope = pump.V - pump.sigma;
  annotation(
    experiment(StartTime = 0, StopTime = 1, Interval = 0.01, Tolerance = 1e-6),
    Documentation(info = "<html>
<p>Time only carries the load pressure from 1 bar to <code>p_load</code>. Below <code>N_d</code> the pump covers its own leakage and gives no flow (dead zone); from there to <code>N_s</code> the flow grows with <code>slope</code> (load zone); above, the drive cannot follow (saturation zone). <code>N_s</code> is the least of what pump, motor,
voltage, torque and cavitation allow, <code>SpeedLimits</code>. The flow over speed at one pressure is <code>FlowZones</code>.</p></html>"));
end FlowPartition;
