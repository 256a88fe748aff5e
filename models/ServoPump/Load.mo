within ServoPump;
model Load "Speed held against a load pressure set by a throttle (paper's Fig. 10, tables 3 and 4)"
  parameter Real N_set(unit = "rev/min", min = -3000, max = 3000) = 600 "Speed command";
  parameter SI.Pressure p_load(min = 1e5, max = 21e6, nominal = 1e7) = 10e6 "Load pressure p_A - p_B that the throttle is set for";
  parameter Real theta_oil(unit = "degC", min = 0, max = 90) = 35 "Temperature of the oil";
  parameter SI.Volume V_A(min = 1e-6, max = 1e-2, nominal = 1e-4, displayUnit = "ml") = 50e-6 "Oil volume at port A";
  parameter SI.Torque T_rated(min = 0.1) = 3.18 "Rated torque of the motor";
  inner Oil.ServoPumpOil oil(T_0 = Modelica.Units.Conversions.from_degC(theta_oil)) "Oil";
  Signal.Ramp speed(height = Modelica.Units.Conversions.from_rpm(N_set), duration = 1) "Speed command";
  replaceable SampledDrive drive constrainedby Drive "1: servo motor";
  Mechanical.Rotational.Inertia rotor(J = 1.8e-4) "Inertia of motor and pump";
  Mechanical.Rotational.BearingFriction friction(tau_c = 0.01, tau_s = 0.05, w_s = 20, d = 0.2e-4) "Dry friction of seal and bearings";
  BenchPump pump(compression = false) "2: pump";
  ShaftRipple ripple "Torque ripple of the load";
  Hydraulic.Volume volume_A(V = V_A, p_start = 5e5) "Oil at port A";
  Hydraulic.Volume volume_B(V = 1e-4, p_start = 4.5e5) "Oil at port B";
  Hydraulic.PressureSensor gauge "3: pressure gauge";
  Hydraulic.ReliefValve relief(p_set = 21e6, q_nom = 4e-5) "4: relief valve";
  Hydraulic.CheckValve check_B "5.2: check valve from the accumulator to B";
  Hydraulic.CheckValve check_A "5.1: check valve from the accumulator to A";
  Hydraulic.Accumulator accumulator(V_0 = 1e-3, p_pre = 3e5, p_start = 5e5) "6: accumulator";
  Throttle throttle(
    p_set = p_load - 5.4e4, q_min = 1e-8,
    A_start = max(0.768e-6*abs(N_set)/60 - 5.5e-7, 1e-8)/(0.65*sqrt(2*p_load/837))) "7: throttle, turned until the pressure is reached (less the drop of the check valve 5.2)";
  Hydraulic.FlowSensor flowSensor_1 "8.1: flow sensor";
  Hydraulic.FlowSensor flowSensor_2 "8.2: flow sensor";
  Real N(unit = "rev/min", nominal = 1e3) "Speed of the shaft";
  Real N_meas(unit = "rev/min", nominal = 1e3) "Speed by the encoder";
  SI.Pressure p_A(nominal = 1e7) "Absolute pressure at port A";
  SI.Pressure p_B(nominal = 1e6) "Absolute pressure at port B";
  SI.VolumeFlowRate Q_A(nominal = 1e-5) "Volume flow out of port A of the pump";
  SI.Torque T_e "Torque of the motor";
  SI.Torque T_sh "Torque of the shaft";
  Real reserve_ideal(unit = "1") "Torque reserve as table 3 prints it: of the ideal torque of the pump";
  Real reserve(unit = "1") "Torque reserve with the losses of pump, bearings and seal";
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, rotor.flange_a);
  connect(rotor.flange_b, friction.flange_a);
  connect(friction.flange_b, pump.flange);
  connect(friction.flange_b, ripple.flange);
  ripple.T_L = pump.V*pump.dp/(2*Modelica.Constants.pi);
  connect(pump.port_a, volume_A.port);
  connect(volume_A.port, gauge.port);
  connect(volume_A.port, relief.port_a);
  connect(relief.port_b, accumulator.port);
  connect(volume_A.port, flowSensor_1.port_a);
  connect(flowSensor_1.port_b, throttle.port_a);
  connect(throttle.port_b, flowSensor_2.port_a);
  connect(flowSensor_2.port_b, accumulator.port);
  connect(accumulator.port, check_A.port_a);
  connect(check_A.port_b, volume_A.port);
  connect(accumulator.port, check_B.port_a);
  connect(check_B.port_b, volume_B.port);
  connect(volume_B.port, pump.port_b);
  N = Modelica.Units.Conversions.to_rpm(pump.w);
  N_meas = Modelica.Units.Conversions.to_rpm(drive.w_meas);
  p_A = volume_A.p;
  p_B = volume_B.p;
  Q_A = pump.Q_A;
  T_e = drive.T_e;
  T_sh = pump.T_sh;
  reserve_ideal = 1 - pump.V*pump.dp/(2*Modelica.Constants.pi)/T_rated;
  reserve = 1 - (pump.T_sh + friction.tau)/T_rated;
  annotation(
    experiment(StartTime = 0, StopTime = 8, Interval = 0.000625, Tolerance = 1e-5),
    Documentation(info = "<html><p>The standard deviation of <code>N_meas</code> over the last 2 s, all samples of the drive, is that of tables 3 (600 r/min, 2 to 19 MPa) and 4 (10 MPa, 300 to 3000 r/min). It comes from a torque ripple once per revolution in proportion to the load, passed on by the speed loop, and from the resolution of the encoder; Stribeck friction adds little.</p></html>"));
end Load;
