within ClosedCircuit;
model MotorBench "The hydraulic motor alone between two pressures, at given speeds and pressures: for its clearances and weights of friction from a map of efficiencies and the flow out of its case"
  Interfaces.RealInput N(unit = "rev/min", start = 1000, nominal = 1e3) "Speed";
  Interfaces.RealInput p(unit = "Pa", start = 1e7, nominal = 1e7) "Pressure of the high side above the low side";
  parameter SI.Pressure p_low(nominal = 1e6) = 2e6 "Pressure of the low side";
  inner Oil.ClosedCircuitOil oil "Oil";
  Mechanical.Rotational.Speed brake "Shaft";
  BenchMachine motor(compression = false, useCasePort = true) "Hydraulic motor: port B is its high side";
  Hydraulic.PressureSource high(useInput = true) "High side";
  Hydraulic.Tank low(p = p_low) "Low side";
  Hydraulic.Tank drain "Where the oil of the case goes";
  Interfaces.RealOutput eta_v(unit = "1") "Volumetric efficiency";
  Interfaces.RealOutput eta_m(unit = "1") "Hydromechanical efficiency";
  Interfaces.RealOutput Q_case(unit = "m3/s", nominal = 1e-5) "Flow out of the case";
protected
  SI.Power ideal(nominal = 1e4) "Power without losses";
equation
  brake.w_ref = Modelica.Units.Conversions.from_rpm(N);
  high.p_in = p + p_low;
  connect(brake.flange, motor.flange);
  connect(motor.port_b, high.port);
  connect(motor.port_a, low.port);
  connect(motor.port_case, drain.port);
  ideal = motor.V*motor.w/(2*Modelica.Constants.pi)*p;
  eta_v*motor.port_b.q*p = ideal;
  eta_m*ideal = -motor.T_sh*motor.w;
  Q_case = motor.Q_case;
  annotation(
    experiment(StartTime = 0, StopTime = 71, Interval = 1, Tolerance = 1e-6),
    Documentation(info = "<html><p>As <code>PumpBench</code>, for the motor: oil drives it, and a brake holds its speed.</p></html>"));
end MotorBench;
