within Hydraulic.Functions;
function orificeFlow "Volume flow through an orifice, turbulent with a laminar transition"
  input SI.Pressure dp "Pressure drop";
  input SI.Area A "Cross section";
  input Real C_d(unit = "1") = 0.65 "Discharge coefficient in turbulent flow";
  input SI.Density rho = 860 "Density";
  input SI.DynamicViscosity mu = 0.04 "Dynamic viscosity";
  input Real Re_cr(unit = "1") = 150 "Reynolds number of the transition";
  input SI.Pressure t_min = 500 "Least width of the transition";
  output SI.VolumeFlowRate q(nominal = 1e-4) "Volume flow at the density rho";
protected
  constant Real pi = Modelica.Constants.pi;
  SI.Pressure t "Width of the transition";
algorithm
  t := max(pi/(8*A*rho)*(Re_cr*mu/C_d)^2, t_min);
  q := C_d*A*sqrt(2/rho)*dp/(dp*dp + t*t)^0.25;
  annotation(Inline = true, Documentation(info = "<html>
<p><code>q = C_d A sqrt(2/rho) dp/(dp^2 + t^2)^(1/4)</code>, odd in dp, with a finite slope at 0. The transition is where the Reynolds number of the orifice, formed with the
hydraulic diameter of a round hole, passes <code>Re_cr</code>: <code>t = pi/(8 A rho) (Re_cr mu/C_d)^2</code>; at 24 mm2/s that is 10 kPa for 1 mm2 and
0.5 kPa for 20 mm2. Source: Bernoulli with contraction, H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 3.4; Re_cr 150 is a usual value for valves.</p></html>"));
end orificeFlow;
