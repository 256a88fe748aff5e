within ClosedCircuit;
model LoadBench "The load machine alone at given speeds and commands: for the coefficients of its polynomial"
  Interfaces.RealInput N(unit = "rev/min", start = 500, nominal = 1e3) "Speed";
  Interfaces.RealInput u(unit = "V", start = 3) "Command";
  Mechanical.Rotational.Speed drive "Shaft";
  Load load "Load machine";
  Interfaces.RealOutput T(unit = "N.m", nominal = 100) "Torque that the load takes, with its friction";
equation
  drive.w_ref = Modelica.Units.Conversions.from_rpm(N);
  connect(drive.flange, load.flange);
  connect(u, load.u);
  T = load.flange.tau;
  annotation(experiment(StartTime = 0, StopTime = 59, Interval = 1, Tolerance = 1e-6));
end LoadBench;
