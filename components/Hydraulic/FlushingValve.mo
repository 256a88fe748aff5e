within Hydraulic;
model FlushingValve "Loop flushing valve: joins the low side of a closed circuit to the outlet"
  Interfaces.HydraulicPort port_a "Side A of the circuit";
  Interfaces.HydraulicPort port_b "Side B of the circuit";
  Interfaces.HydraulicPort port_out "Outlet, to the case or tank";
  parameter SI.Pressure dp_open(min = 1e3, max = 1e7, nominal = 1e6) = 7e5 "Pressure difference at which the spool is open";
  parameter SI.Area A(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 3e-6 "Cross section when open";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  VariableOrifice way_a(A_max = A, A_leak = A_leak) "From A";
  VariableOrifice way_b(A_max = A, A_leak = A_leak) "From B";
equation
  way_a.u = Smooth.step(2*(port_b.p - port_a.p)/dp_open - 1);
  way_b.u = Smooth.step(2*(port_a.p - port_b.p)/dp_open - 1);
  connect(port_a, way_a.port_a);
  connect(way_a.port_b, port_out);
  connect(port_b, way_b.port_a);
  connect(way_b.port_b, port_out);
  annotation(Documentation(info = "<html><p>A spool between both sides of a closed circuit joins the low side to the outlet as soon as the high side exceeds it by <code>dp_open</code>; in the middle both are closed. The spool has no mass: valid for changes slower than some 10 ms. Source: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001, closed circuits.</p></html>"));
end FlushingValve;
