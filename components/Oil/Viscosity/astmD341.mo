within Oil.Viscosity;
function astmD341 "Double logarithmic law through two points: log10 log10(nu + 0.7) = A - B log10 T, nu in mm2/s"
  extends Oil.Viscosity.Law;
  input SI.Density rho = 860 "Density at the temperature of the circuit";
  input SI.KinematicViscosity nu_1 = 46e-6 "Kinematic viscosity at T_1";
  input SI.Temperature T_1 = 313.15 "First temperature";
  input SI.KinematicViscosity nu_2 = 6.8e-6 "Kinematic viscosity at T_2";
  input SI.Temperature T_2 = 373.15 "Second temperature";
protected
  Real Z_1 "log10 log10 of the first point";
  Real Z_2 "log10 log10 of the second point";
  Real B "Slope";
algorithm
  Z_1 := log10(log10(nu_1*1e6 + 0.7));
  Z_2 := log10(log10(nu_2*1e6 + 0.7));
  B := (Z_1 - Z_2)/log10(T_2/T_1);
  mu := rho*1e-6*(10^(10^(Z_1 - B*log10(T/T_1))) - 0.7);
  annotation(Inline = true, Documentation(info = "<html><p>Valid for 2 mm2/s and more, over the whole range of hydraulic practice. Source: ASTM D341, the form with the constant 0.7.</p></html>"));
end astmD341;
