within Hydraulic.Examples;
model VariablePumpExample "A pump whose displacement goes over centre, in a closed circuit with its charge line"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Ramp speed(height = 150, duration = 0.2);
  Mechanical.Rotational.Speed drive;
  Pump pump(V = 10e-6, G = 5e-13, useInput = true);
  Signal.Sine stroke(f = 2);
  Volume side_A(V = 2e-4, p_start = 20e5) "High side while the stroke is positive";
  Volume side_B(V = 2e-4, p_start = 20e5) "High side while the stroke is negative";
  Orifice load(A = 2e-6) "Between both sides";
  Tank charge(p = 20e5) "Charge pressure: replaces what the oil loses in volume";
  CheckValve check_A "From the charge line to A";
  CheckValve check_B "From the charge line to B";
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, pump.flange);
  connect(stroke.y, pump.u);
  connect(pump.port_a, side_A.port);
  connect(pump.port_b, side_B.port);
  connect(side_A.port, load.port_a);
  connect(load.port_b, side_B.port);
  connect(charge.port, check_A.port_a);
  connect(check_A.port_b, side_A.port);
  connect(charge.port, check_B.port_a);
  connect(check_B.port_b, side_B.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end VariablePumpExample;
