within ServoPump;
model NoLoad "Flow over speed without load (paper's Fig. 7)"
  parameter Real N_set(unit = "rev/min", min = -3000, max = 3000) = 3000 "Speed at the end of the ramp";
  parameter Real ramp(unit = "rev/(min.s)", min = 1) = 300 "Rise of the speed";
  parameter SI.Volume V_A(min = 1e-6, max = 1e-2, nominal = 1e-4, displayUnit = "ml") = 100e-6 "Oil volume at port A";
  parameter Real theta_oil(unit = "degC", min = 0, max = 90) = 35 "Temperature of the oil";
  parameter Boolean compression = true "true: with the compression flow of the pump's chambers" annotation(Evaluate = true);
  inner Oil.ServoPumpOil oil(T_0 = Modelica.Units.Conversions.from_degC(theta_oil)) "Oil";
  Signal.Ramp speed(height = Modelica.Units.Conversions.from_rpm(N_set), duration = abs(N_set)/ramp) "Speed command";
  replaceable FieldOrientedDrive motor constrainedby Drive "Servo motor";
  Mechanical.Rotational.Inertia rotor(J = 1.8e-4) "Inertia of motor and pump";
  BenchPump pump(compression = compression) "Pump";
  Hydraulic.Volume volume_A(V = V_A) "Line at port A";
  Hydraulic.FlowSensor flowMeter "Flow meter";
  Hydraulic.CheckValve line(p_crack = 0.8e5, p_open = 1.2e5, A_max = 1e-4) "Line to the reservoir, with a spring-loaded check valve";
  Hydraulic.CheckValve lineBack(p_crack = 0.3e5, p_open = 0.5e5, A_max = 1e-4) "The way back out of the reservoir, for negative speeds";
  Hydraulic.Tank reservoir "Reservoir";
  Real N(unit = "rev/min", nominal = 1e3) "Speed of the shaft";
  Real N_meas(unit = "rev/min", nominal = 1e3) "Speed by the encoder";
  SI.Pressure p_A(nominal = 1e6) "Absolute pressure at port A";
  SI.Pressure p_B(nominal = 1e6) "Absolute pressure at port B";
  SI.VolumeFlowRate Q_A(nominal = 1e-5) "Volume flow out of port A of the pump";
  SI.Torque T_e "Torque of the motor";
  SI.Torque T_sh "Torque of the shaft";
equation
  connect(speed.y, motor.w_ref);
  connect(motor.flange, rotor.flange_a);
  connect(rotor.flange_b, pump.flange);
  connect(pump.port_b, reservoir.port);
  connect(pump.port_a, volume_A.port);
  connect(volume_A.port, flowMeter.port_a);
  connect(flowMeter.port_b, line.port_a);
  connect(line.port_b, reservoir.port);
  connect(reservoir.port, lineBack.port_a);
  connect(lineBack.port_b, flowMeter.port_b);
  N = Modelica.Units.Conversions.to_rpm(pump.w);
  N_meas = Modelica.Units.Conversions.to_rpm(motor.w_meas);
  p_A = volume_A.p;
  p_B = reservoir.p;
  Q_A = pump.Q_A;
  T_e = motor.T_e;
  T_sh = pump.T_sh;
  annotation(
    experiment(StartTime = 0, StopTime = 11, Interval = 0.02, Tolerance = 1e-6),
    Documentation(info = "<html><p>The flow over speed is a straight line. Its slope is the displacement less the shear leakage, 0.7682 ml/r, and the compression flow of the chambers at the 0.1 MPa of the line takes a thousandth of it. That pressure also sets the direction of the shear leakage.</p></html>"));
end NoLoad;
