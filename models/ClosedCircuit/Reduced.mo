within ClosedCircuit;
model Reduced "Circuit with a low side of constant pressure: three states of motion and pressure, and the motor's"
  parameter MotorType motor = MotorType.A "Motor of the drive" annotation(Evaluate = true);
  parameter Control control = Control.V_f "Control of the drive" annotation(Evaluate = true);
  parameter SI.Inertia J_L(min = 0) = 2 "Inertia of the load";
  parameter SI.Frequency f(min = 0, max = 100) = 27.74 "Frequency command, where its source is constant";
  parameter SI.Voltage u(min = 0, max = 10) = 3 "Load command, where its source is constant";
  parameter SI.Pressure p_low(nominal = 1e6) = 2e6 "Pressure of the low side";
  parameter SI.Volume V_line(min = 1e-6, displayUnit = "l") = 1.5e-3 "Volume of the high side";
  parameter Boolean steady = true "true: all stands at the start, as the commands ask; false: starts from the values of the components" annotation(Evaluate = true);
  inner Oil.ClosedCircuitOil oil "Oil";
  replaceable Signal.Constant frequency(k = f) constrainedby Signal.Bases.Source "Source of the frequency command";
  replaceable Signal.Constant command(k = u) constrainedby Signal.Bases.Source "Source of the load command";
  Electrical.Drives.VfInverter inverter if control == Control.V_f "1: inverter";
  Electrical.Machines.InductionMotorSteady electricMotor(
    R_r = if motor == MotorType.A then 0.40 else 0.16,
    B = 0) if control == Control.V_f "2: induction motor";
  Electrical.Drives.FieldOrientedInductionDrive vectorDrive(sensorless = true, steady = steady, R_r = if motor == MotorType.A then 0.40 else 0.16) if control == Control.SFVC "1, 2: drive under vector control";
  Electrical.Drives.SensorlessVectorDrive reducedDrive(steady = steady) if control == Control.SFVC_reduced "1, 2: the same, reduced to lags";
  Signal.Gain synchronous(k = Modelica.Constants.pi) if control == Control.SFVC or control == Control.SFVC_reduced "Synchronous speed of four poles";
  Mechanical.Rotational.Inertia shaft_1(J = 0.35 + 0.02, w(start = 50)) "Rotors of motor and pump";
  Mechanical.Rotational.Damper bearing_1(d = 0.02) "Friction of the motor";
  BenchMachine pump "5: pump";
  Hydraulic.Volume highSide(V = V_line, p_start = 5e6) "High side";
  Hydraulic.Tank lowSide(p = p_low) "Low side";
  BenchMachine hydraulicMotor(compression = false) "11: hydraulic motor";
  Mechanical.Rotational.Inertia shaft_2(J = 0.02 + J_L, w(start = 40)) "Hydraulic motor and load";
  Load load "13, 16: load machine";
  Mechanical.Rotational.Fixed housing "Housing";
  Real n_p(unit = "rev/min", nominal = 1e3) "Speed of the pump";
  Real n_m(unit = "rev/min", nominal = 1e3) "Speed of the hydraulic motor";
  SI.Pressure p(nominal = 1e7) "Pressure of the high side above the low side";
  SI.Torque T_e(nominal = 100) "Torque of the electric motor";
initial equation
  if steady then
    der(shaft_1.w) = 0;
    der(shaft_2.w) = 0;
    der(highSide.p) = 0;
  end if;
equation
  connect(frequency.y, inverter.f_ref);
  connect(inverter.f, electricMotor.f);
  connect(inverter.U, electricMotor.U);
  connect(electricMotor.flange, shaft_1.flange_a);
  connect(frequency.y, synchronous.u);
  connect(synchronous.y, vectorDrive.w_ref);
  connect(vectorDrive.flange, shaft_1.flange_a);
  connect(synchronous.y, reducedDrive.w_ref);
  connect(reducedDrive.flange, shaft_1.flange_a);
  connect(shaft_1.flange_b, bearing_1.flange_a);
  connect(bearing_1.flange_b, housing.flange);
  connect(shaft_1.flange_b, pump.flange);
  connect(pump.port_a, highSide.port);
  connect(pump.port_b, lowSide.port);
  connect(highSide.port, hydraulicMotor.port_b);
  connect(hydraulicMotor.port_a, lowSide.port);
  connect(hydraulicMotor.flange, shaft_2.flange_a);
  connect(shaft_2.flange_b, load.flange);
  connect(command.y, load.u);
  n_p = Modelica.Units.Conversions.to_rpm(shaft_1.w);
  n_m = Modelica.Units.Conversions.to_rpm(shaft_2.w);
  p = highSide.p - p_low;
  T_e = shaft_1.flange_a.tau;
  annotation(experiment(StartTime = 0, StopTime = 40, Interval = 0.01, Tolerance = 1e-7));
end Reduced;
