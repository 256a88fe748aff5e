within Hydraulic;
model Cushion "End cushioning: the outlet of a chamber narrows before the end stop"
  extends Bases.TwoPort;
  Interfaces.TranslationalFlange flange "Piston; takes no force";
  parameter SI.Position s_end = 0 "Position of the end stop";
  parameter Integer side(min = -1, max = 1) = 1 "1: the end lies at small positions, -1: at large ones";
  parameter SI.Length length(min = 1e-5, max = 1, nominal = 1e-2) = 0.02 "Length of the cushioning";
  parameter SI.Area A_open(min = 1e-9, nominal = 1e-5, displayUnit = "mm2") = 5e-5 "Cross section outside the cushioning";
  parameter SI.Area A_end(min = 1e-12, nominal = 1e-7, displayUnit = "mm2") = 2e-7 "Cross section at the end stop";
  parameter SI.Area A_check(min = 1e-10, nominal = 1e-5, displayUnit = "mm2") = 2e-5 "Cross section of the check valve that lets oil in, from b to a";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
protected
  Real x(unit = "1") "Way left in the cushioning, 0 to 1";
equation
  assert(A_open > A_end and A_end > 0, "A_open must exceed A_end, which must be positive");
  assert(side == 1 or side == -1, "side must be 1 or -1");
  x = Smooth.step(side*(flange.s - s_end)/length);
  q = Hydraulic.Functions.orificeFlow(dp, A_end + (A_open - A_end)*x + A_check*Smooth.step(-dp/1e5), C_d, rho, mu_in);
  flange.f = 0;
  annotation(Documentation(info = "<html><p>The cross section shrinks smoothly from <code>A_open</code> to <code>A_end</code> over the last part of the stroke; a check valve lets oil in for the way out. Put it between port and chamber of a cylinder, its flange at the rod. Valid for throttles of constant shape; the force of the cushioned pressure acts in the chamber. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012, end cushioning.</p></html>"));
end Cushion;
