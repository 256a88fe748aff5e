within Oil.Viscosity;
function exponential "Exponential law: mu = mu_ref exp(-lambda (T - T_mu))"
  extends Oil.Viscosity.Law;
  input SI.DynamicViscosity mu_ref = 0.01155 "Dynamic viscosity at T_mu";
  input SI.Temperature T_mu = 323.15 "Temperature of mu_ref";
  input SI.LinearTemperatureCoefficient lambda = 0.0357 "Viscosity falls by exp(-lambda) per kelvin";
algorithm
  mu := mu_ref*exp(-lambda*(T - T_mu));
  annotation(Inline = true, Documentation(info = "<html><p>Good within some 20 K of T_mu. Source: Zhang et al., Processes 2021, 9, 814, leakage formula of section 4.2.1
(reference temperature 50 degC).</p></html>"));
end exponential;
