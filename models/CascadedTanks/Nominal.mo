within CascadedTanks;
model Nominal "The tanks without overflow, pump without dead zone, sensor without end"
  parameter Real k_p(unit = "m3/(s.V)", min = 0, max = 1e-2, nominal = 1e-4) = 7.47e-5 "Flow of the pump over its voltage";
  parameter SI.Area a_1(min = 1e-7, max = 1e-3, nominal = 1e-5) = 3.85e-5 "Outlet of the upper tank";
  parameter SI.Area a_2(min = 1e-7, max = 1e-3, nominal = 1e-5) = 6.41e-5 "Outlet of the lower tank";
  parameter SI.Area A_1(min = 1e-6, max = 10, nominal = 1e-2) = 1e-2 "Cross section of the upper tank";
  parameter SI.Area A_2(min = 1e-6, max = 10, nominal = 1e-2) = 1e-2 "Cross section of the lower tank";
  parameter Real k_y(unit = "V/m", min = 0, nominal = 10) = 10 "Level sensor";
  parameter SI.Height h_1_start(min = 0, max = 10, nominal = 0.5) = 1.40 "Level of the upper tank at the start";
  parameter SI.Height h_2_start(min = 0, max = 10, nominal = 0.5) = 0.513 "Level of the lower tank at the start";
  inner Oil.Water oil "What the tanks hold";
  Interfaces.RealInput u(unit = "V", nominal = 3) "Voltage of the pump";
  Interfaces.RealOutput y(unit = "V", nominal = 5) "Level of the lower tank, measured";
  Signal.Gain pump(k = k_p) "Pump";
  Hydraulic.FlowSource feed(useInput = true) "What it delivers";
  OpenTank upper(A = A_1, h_start = h_1_start) "Upper tank";
  OpenTank lower(A = A_2, h_start = h_2_start) "Lower tank";
  FreeOutlet outlet_1(a = a_1) "Outlet of the upper tank";
  FreeOutlet outlet_2(a = a_2) "Outlet of the lower tank";
  Hydraulic.Tank reservoir "Reservoir";
equation
  connect(u, pump.u);
  connect(pump.y, feed.q_in);
  connect(feed.port, upper.port);
  connect(upper.port, outlet_1.port_a);
  connect(outlet_1.port_b, lower.port);
  connect(lower.port, outlet_2.port_a);
  connect(outlet_2.port_b, reservoir.port);
  y = k_y*lower.h;
  annotation(
    experiment(StartTime = 0, StopTime = 4092, Interval = 4, Tolerance = 1e-6),
    Documentation(info = "<html><p>Four numbers from a fit to the estimation record (0.60 V there, 0.67 V on the validation record): pump, two outlets and the upper tank's first level.</p></html>"));
end Nominal;
