within Electrical.Examples;
model InductionMotorHeatExample "A motor warms up under load, and slips more"
  Signal.Constant frequency(k = 50);
  Drives.VfInverter inverter;
  Machines.InductionMotorSteady motor(useHeatPort = true);
  Mechanical.Rotational.Inertia rotor(J = 0.4, w(start = 150));
  Mechanical.Rotational.ConstantTorque load(tau_constant = -150);
  Thermal.HeatCapacitor windings(C = 8e3);
  Thermal.ThermalConductor cooling(G = 30);
  Thermal.FixedTemperature hall(T = 293.15);
equation
  connect(frequency.y, inverter.f_ref);
  connect(inverter.f, motor.f);
  connect(inverter.U, motor.U);
  connect(motor.flange, rotor.flange_a);
  connect(rotor.flange_b, load.flange);
  connect(motor.heatPort, windings.port);
  connect(windings.port, cooling.port_a);
  connect(cooling.port_b, hall.port);
  annotation(experiment(StartTime = 0, StopTime = 900, Interval = 1, Tolerance = 1e-6));
end InductionMotorHeatExample;
