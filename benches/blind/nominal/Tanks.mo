model Tanks "Two tanks side by side, joined by a pipe near the bottom, each with an outlet"
  parameter Real k_p(unit = "m3/(s.V)", min = 0, nominal = 1e-5) = 3e-5 "Flow of the pump over its voltage";
  parameter Modelica.Units.SI.Area a_1(min = 0, nominal = 1e-5) = 1.2e-5 "Outlet of the left tank";
  parameter Modelica.Units.SI.Area a_12(min = 0, nominal = 1e-5) = 4e-5 "Pipe between the tanks";
  parameter Modelica.Units.SI.Area a_2(min = 0, nominal = 1e-5) = 3e-5 "Outlet of the right tank";
  parameter Modelica.Units.SI.Area A_1(min = 0, nominal = 1e-2) = 1e-2 "Cross section of the left tank";
  parameter Modelica.Units.SI.Area A_2(min = 0, nominal = 1e-2) = 1e-2 "Cross section of the right tank";
  inner Oil.Water oil "What the tanks hold";
  Interfaces.RealInput u(unit = "V", nominal = 3) "Voltage of the pump";
  Signal.Gain pump(k = k_p) "Pump";
  Hydraulic.FlowSource feed(useInput = true) "What it delivers";
  CascadedTanks.OpenTank left(A = A_1, h_start = 0.5) "Left tank";
  CascadedTanks.OpenTank right(A = A_2, h_start = 0.4) "Right tank";
  CascadedTanks.FreeOutlet outlet_1(a = a_1) "Outlet of the left tank";
  CascadedTanks.FreeOutlet outlet_2(a = a_2) "Outlet of the right tank";
  TanksPipe pipe(a = a_12) "Pipe";
  Hydraulic.Tank reservoir "Reservoir";
  Modelica.Units.SI.Height h_1(nominal = 0.5) "Level of the left tank";
  Modelica.Units.SI.Height h_2(nominal = 0.5) "Level of the right tank";
equation
  connect(u, pump.u);
  connect(pump.y, feed.q_in);
  connect(feed.port, left.port);
  connect(left.port, outlet_1.port_a);
  connect(outlet_1.port_b, reservoir.port);
  connect(left.port, pipe.port_a);
  connect(pipe.port_b, right.port);
  connect(right.port, outlet_2.port_a);
  connect(outlet_2.port_b, reservoir.port);
  h_1 = left.h;
  h_2 = right.h;
end Tanks;

model TanksPipe "Short pipe, both ends under water"
  Interfaces.HydraulicPort port_a(p(nominal = 1e5)) "One end";
  Interfaces.HydraulicPort port_b(p(nominal = 1e5)) "Other end";
  parameter Modelica.Units.SI.Area a(min = 0, nominal = 1e-5) = 4e-5 "Cross section that acts";
  parameter Modelica.Units.SI.Density rho(min = 500) = 1000 "Density of the water";
  parameter Modelica.Units.SI.Pressure w(min = 1e-3, nominal = 10) = 20 "Pressure below which the root is rounded";
equation
  port_a.q = a*sqrt(2/rho)*Smooth.root(port_a.p - port_b.p, w);
  port_a.q + port_b.q = 0;
end TanksPipe;
