within Hydraulic;
model LocalLoss "Bend, junction or change of section with a loss coefficient"
  extends Bases.TwoPort;
  parameter SI.Diameter d(min = 1e-3, max = 1, nominal = 1e-2) = 1e-2 "Diameter to which zeta belongs";
  parameter Real zeta(unit = "1", min = 1e-3, max = 1e3) = 0.3 "Loss coefficient: bend 0.2 to 0.5, right angle 1.2, inlet 0.5, outlet 1";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 500 "Reynolds number of the laminar transition";
equation
  assert(zeta > 0 and d > 0, "Loss coefficient zeta and diameter d must be positive");
  q = Functions.orificeFlow(dp, Modelica.Constants.pi*d^2/4, 1/sqrt(zeta), rho, mu_in, Re_cr, 1);
  annotation(Documentation(info = "<html><p><code>dp = zeta rho/2 v^2</code> with the speed in the diameter d, laminar below <code>Re_cr</code>. Coefficients: I. E. Idelchik, Handbook of Hydraulic Resistance, 2008.</p></html>"));
end LocalLoss;
