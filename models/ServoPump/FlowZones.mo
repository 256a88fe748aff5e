within ServoPump;
model FlowZones "Flow over the commanded speed at a load pressure: dead, load and saturation zone (paper's Fig. 2)"
  extends SpeedLimits(pump(port_a(p(start = p_low - 5e4)), port_b(p(start = p_low + p_load + 8e4))));
  parameter Real N_end(unit = "rev/min", min = 1, max = 10000) = 3600 "The command goes from -N_end to N_end";
  parameter SI.Pressure p_load(min = 1e5, max = 25e6, nominal = 1e7) = 21e6 "Pressure above the low side that the load asks for, against either direction";
  parameter Real theta_oil(unit = "degC", min = 0, max = 90) = 35 "Temperature of the oil";
  inner Oil.ServoPumpOil oil(T_0 = Modelica.Units.Conversions.from_degC(theta_oil)) "Oil";
  Signal.Ramp command(offset = -N_end, height = 2*N_end, duration = 10) "Commanded speed in r/min";
  Mechanical.Rotational.Speed motor "Motor: what it is commanded, up to its limits";
  Hydraulic.ReliefValveLinear load_A(p_set = p_load) "Load of A: lets pass what comes at its pressure";
  Hydraulic.ReliefValveLinear load_B(p_set = p_load) "Load of B";
  Hydraulic.CheckValve check_A "From the low side to A";
  Hydraulic.CheckValve check_B "From the low side to B";
  Hydraulic.Tank low(p = p_low) "Low side";
  Real N_set(unit = "rev/min", nominal = 1e3) "Commanded speed";
  Real N(unit = "rev/min", nominal = 1e3) "Speed";
  SI.VolumeFlowRate Q(nominal = 1e-5) "Flow to the load at its pressure, negative out of B";
  SI.VolumeFlowRate Q_ideal(nominal = 1e-5) "Displacement times commanded speed";
equation
  dp = p_load;
  N_set = command.y;
  N = min(max(N_set, -N_s), N_s);
  motor.w_ref = Modelica.Units.Conversions.from_rpm(N);
  connect(motor.flange, pump.flange);
  connect(pump.port_a, load_A.port_a);
  connect(load_A.port_b, low.port);
  connect(pump.port_b, load_B.port_a);
  connect(load_B.port_b, low.port);
  connect(low.port, check_A.port_a);
  connect(check_A.port_b, pump.port_a);
  connect(low.port, check_B.port_a);
  connect(check_B.port_b, pump.port_b);
  Q = load_A.port_a.q - load_B.port_a.q;
  Q_ideal = pump.V*N_set/60;
  annotation(
    experiment(StartTime = 0, StopTime = 10, Interval = 0.01, Tolerance = 1e-6),
    Documentation(info = "<html>
<p>Time only carries the command, slowly enough that nothing is accelerated or compressed. While the pump cannot cover its leakage at <code>p_load</code> its pressure stays below, and nothing flows: the dead zone. Above, the flow grows by 0.7682 ml per revolution; at <code>N_s</code> (<code>SpeedLimits</code>) the speed ends, and the flow with it.</p></html>"));
end FlowZones;
