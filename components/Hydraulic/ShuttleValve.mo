within Hydraulic;
model ShuttleValve "Shuttle valve: the higher of two pressures passes on"
  Interfaces.HydraulicPort port_a "First inlet";
  Interfaces.HydraulicPort port_b "Second inlet";
  Interfaces.HydraulicPort port_out "Outlet";
  parameter SI.Area A(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 5e-6 "Cross section when open";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter SI.Pressure w(min = 100, max = 1e6, nominal = 1e4) = 1e4 "Pressure difference that moves the ball";
  VariableOrifice way_a(A_max = A, A_leak = A_leak) "From a";
  VariableOrifice way_b(A_max = A, A_leak = A_leak) "From b";
  Real x(unit = "1") "1: a is open";
equation
  x = (1 + Smooth.sgn(port_a.p - port_b.p, w))/2;
  way_a.u = x;
  way_b.u = 1 - x;
  connect(port_a, way_a.port_a);
  connect(way_a.port_b, port_out);
  connect(port_b, way_b.port_a);
  connect(way_b.port_b, port_out);
  annotation(Documentation(info = "<html><p>The outlet is joined to the side of higher pressure; the ball changes over smoothly within the pressure difference w. Within w both inlets are joined to each other through the ball: valid where they seldom stand so close. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012.</p></html>"));
end ShuttleValve;
