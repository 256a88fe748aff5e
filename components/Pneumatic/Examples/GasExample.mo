within Pneumatic.Examples;
model GasExample "Argon and its own reference atmosphere flow into a vessel"
  inner Gas gas(R_s = 208.1, kappa = 1.667, T_0 = 273.15) "Argon";
  Reservoir bottle(p = 5e5, T = 300);
  Orifice orifice(C = 0.5e-8);
  Volume vessel(V = 2e-3);
equation
  connect(bottle.port, orifice.port_a);
  connect(orifice.port_b, vessel.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end GasExample;
