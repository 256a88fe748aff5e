within ServoPump;
model DeadZone "Pressure building at very low speed with port A closed (paper's Fig. 8, result Fig. 9)"
  parameter Real N_set(unit = "rev/min", min = -100, max = 100) = 48 "Speed at which the ramp ends; negative builds the pressure at B";
  parameter Real ramp(unit = "rev/(min.s)", min = 1e-3, max = 100) = 0.5 "Rise of the speed";
  parameter SI.Volume V_A(min = 1e-6, max = 1e-2, nominal = 1e-4, displayUnit = "ml") = 50e-6 "Oil volume at port A";
  parameter Real theta_oil(unit = "degC", min = 0, max = 90) = 35 "Temperature of the oil";
  parameter Boolean compression = true "true: with the compression flow of the pump's chambers" annotation(Evaluate = true);
  inner Oil.ServoPumpOil oil(T_0 = Modelica.Units.Conversions.from_degC(theta_oil)) "Oil";
  Signal.Ramp speed(height = Modelica.Units.Conversions.from_rpm(N_set), duration = abs(N_set)/ramp) "Speed command";
  replaceable FieldOrientedDrive motor constrainedby Drive "1: servo motor";
  Mechanical.Rotational.Inertia rotor(J = 1.8e-4) "Inertia of motor and pump";
  BenchPump pump(compression = compression) "2: pump";
  Hydraulic.Volume volume_A(V = V_A, p_start = 5e5) "Oil at port A, up to the valve";
  Hydraulic.Volume volume_B(V = 1e-4, p_start = 5e5) "Oil at port B";
  Hydraulic.PressureSensor gauge "3: pressure gauge";
  Hydraulic.FlowSensor flowSensor "7: flow sensor";
  Hydraulic.Plug valve "4: solenoid valve, closed";
  Hydraulic.CheckValve check_A "5.1: check valve from the accumulator to A";
  Hydraulic.CheckValve check_B "5.2: check valve from the accumulator to B";
  Hydraulic.AccumulatorPolytropic accumulator(V_0 = 1e-3, p_pre = 3e5, p_start = 5e5, n = 1.0) "6: accumulator";
  Real N(unit = "rev/min", nominal = 10) "Speed of the shaft";
  Real N_meas(unit = "rev/min", nominal = 10) "Speed by the encoder";
  SI.Pressure p_A(nominal = 1e7) "Absolute pressure at port A";
  SI.Pressure p_B(nominal = 1e6) "Absolute pressure at port B";
  SI.VolumeFlowRate Q_A(nominal = 1e-7) "Volume flow out of port A of the pump";
  SI.Torque T_e "Torque of the motor";
  SI.Torque T_sh "Torque of the shaft";
equation
  connect(speed.y, motor.w_ref);
  connect(motor.flange, rotor.flange_a);
  connect(rotor.flange_b, pump.flange);
  connect(pump.port_a, volume_A.port);
  connect(volume_A.port, gauge.port);
  connect(volume_A.port, flowSensor.port_a);
  connect(flowSensor.port_b, valve.port);
  connect(pump.port_b, volume_B.port);
  connect(accumulator.port, check_A.port_a);
  connect(check_A.port_b, volume_A.port);
  connect(accumulator.port, check_B.port_a);
  connect(check_B.port_b, volume_B.port);
  N = Modelica.Units.Conversions.to_rpm(pump.w);
  N_meas = Modelica.Units.Conversions.to_rpm(motor.w_meas);
  p_A = volume_A.p;
  p_B = volume_B.p;
  Q_A = pump.Q_A;
  T_e = motor.T_e;
  T_sh = pump.T_sh;
  annotation(
    experiment(StartTime = 0, StopTime = 100, Interval = 0.1, Tolerance = 1e-6),
    Documentation(info = "<html>
<p>Port A is closed, the speed rises slowly, and the pressure at A follows such that the pump just covers its own losses: the dead zone of the flow. A straight line through pressure over speed from 50 to 210 bar has the slope 6.8 bar/(r/min) and the
intercept -78 bar (paper: 6.95 and -75.1). The ramp matters: the volume at A must be filled, a lag of <code>V_A/(beta G)</code> = 1.9 s, which shifts the line by 1 r/min at the default ramp and by 4 r/min at 2 r/min per s. Without <code>compression</code> the slope is 6.98.</p>
<p>The closed solenoid valve is taken as tight. The motor is a PMSM with field-oriented current control on an averaged inverter; <code>redeclare ServoPump.IdealDrive motor</code> holds the speed exactly; a recorded speed cannot drive an inertia exactly, so <code>break rotor</code> goes with it then.</p></html>"));
end DeadZone;
