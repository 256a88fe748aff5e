within Hydraulic;
model WilsonMachine "Displacement machine with the loss coefficients of Wilson and Schloesser"
  extends Bases.Machine(compression = false);
  parameter Real c_s(unit = "1", min = 0) = 1e-9 "Laminar leakage: c_s V dp/(2 pi mu)";
  parameter Real c_t(unit = "1", min = 0) = 0 "Turbulent leakage: c_t V^(2/3) sqrt(2 dp/rho)";
  parameter Real c_d(unit = "1", min = 0) = 1e5 "Viscous friction: c_d V mu w/(2 pi)";
  parameter Real c_f(unit = "1", min = 0, max = 1) = 0.02 "Dry friction: c_f V dp/(2 pi)";
  parameter SI.Torque T_0(min = 0) = 0 "Constant friction";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed in dry friction";
equation
  assert(c_s >= 0 and c_t >= 0 and c_d >= 0 and c_f >= 0 and T_0 >= 0, "Loss coefficients must not be negative");
  Q_leak = c_s*D*dp/mu + c_t*V^(2/3)*sqrt(2/rho_high)*dp/(dp^2 + 1e6)^0.25;
  T_loss = c_d*D*mu*w + (c_f*D*Smooth.mag(dp, 1e4) + T_0)*Smooth.sgn(w, w_s);
  annotation(Documentation(info = "<html><p>Source: W. E. Wilson, Proc. ASME 1946; W. M. J. Schloesser, Hydraulic Power Transmission 1961. The leakage by slip is <code>c_s dp V/(2 pi mu)</code>; the turbulent one is laminar within 1 kPa of no pressure difference. One coefficient each over the whole range: good within some per cent of efficiency at half to full load, poor at low speed. Compression of the oil is not told apart from slip.</p></html>"));
end WilsonMachine;
