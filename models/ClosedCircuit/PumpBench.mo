within ClosedCircuit;
model PumpBench "The pump alone between two pressures, at given speeds and pressures: for its clearances and weights of friction from a map of efficiencies and the flow out of its case"
  Interfaces.RealInput N(unit = "rev/min", start = 1000, nominal = 1e3) "Speed";
  Interfaces.RealInput p(unit = "Pa", start = 1e7, nominal = 1e7) "Pressure of the high side above the low side";
  parameter SI.Pressure p_low(nominal = 1e6) = 2e6 "Pressure of the low side";
  inner Oil.ClosedCircuitOil oil "Oil";
  Mechanical.Rotational.Speed drive "Shaft";
  BenchMachine pump(useCasePort = true) "Pump";
  Hydraulic.PressureSource high(useInput = true) "High side";
  Hydraulic.Tank low(p = p_low) "Low side";
  Hydraulic.Tank drain "Where the oil of the case goes";
  Interfaces.RealOutput eta_v(unit = "1") "Volumetric efficiency";
  Interfaces.RealOutput eta_m(unit = "1") "Hydromechanical efficiency";
  Interfaces.RealOutput Q_case(unit = "m3/s", nominal = 1e-5) "Flow out of the case";
protected
  SI.Power ideal(nominal = 1e4) "Power without losses";
equation
  drive.w_ref = Modelica.Units.Conversions.from_rpm(N);
  high.p_in = p + p_low;
  connect(drive.flange, pump.flange);
  connect(pump.port_a, high.port);
  connect(pump.port_b, low.port);
  connect(pump.port_case, drain.port);
  ideal = pump.V*pump.w/(2*Modelica.Constants.pi)*p;
  eta_v*ideal = pump.Q_A*p;
  eta_m*pump.T_sh*pump.w = ideal;
  Q_case = pump.Q_case;
  annotation(
    experiment(StartTime = 0, StopTime = 71, Interval = 1, Tolerance = 1e-6),
    Documentation(info = "<html><p>Slippers, pistons and the outer land of the valve plate leak to the case, its inner land from port to port. Without <code>Q_case</code> a map cannot tell the three gaps apart: all leak in proportion to the pressure.</p></html>"));
end PumpBench;
