within Hydraulic;
model OrbitMotor "Orbit motor: slow, with high torque, of 50 to 800 ml per revolution"
  extends Bases.Machine(V = 2e-4, deadVolume = 0.1);
  parameter Real G(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 2e-12 "Conductance of the leakage of rotor and distributor at mu_G";
  parameter SI.Pressure p_G(min = 1e5, max = 1e9, nominal = 1e7) = 200e5 "Pressure difference that widens the gaps so that the conductance doubles";
  parameter SI.Torque T_0(min = 0, max = 1e3, nominal = 1) = 5 "Dry friction independent of pressure";
  parameter Real k_p(unit = "1", min = 0, max = 0.5) = 0.07 "Dry friction over the ideal torque";
  parameter Real k_st(unit = "1", min = 1, max = 4) = 1.8 "Friction at break-away over dry friction";
  parameter SI.AngularVelocity w_st(min = 1e-2, max = 100, nominal = 1) = 2 "Speed over which that excess falls to 37 %";
  parameter SI.RotationalDampingConstant b(min = 0, max = 100, nominal = 0.1) = 0.05 "Viscous friction";
  parameter SI.Pressure dp_idle(min = 0, max = 1e7, nominal = 1e5) = 8e5 "Pressure drop of channels and distributor at w_idle";
  parameter SI.AngularVelocity w_idle(min = 1, max = 1e3, nominal = 10) = 30 "Speed of dp_idle";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 0.1) = 0.1 "Width of the sign of speed in the dry friction";
  SI.Torque T_out(nominal = 100) "Torque that the motor gives to the shaft";
equation
  assert(G >= 0 and p_G > 0, "G must not be negative, p_G must be positive");
  assert(T_0 >= 0 and k_p >= 0 and k_st >= 1 and b >= 0 and dp_idle >= 0, "The friction must not be negative, k_st at least 1");
  Q_leak = thin*G*(1 + Smooth.mag(dp, 1e4)/p_G)*dp;
  T_loss = (T_0 + k_p*D*Smooth.mag(dp, 1e4))*(1 + (k_st - 1)*exp(-(w/w_st)^2))*Smooth.sgn(w, w_s) + b*w + D*dp_idle*Smooth.mag(w, 1e-2)*w/w_idle^2;
  T_out = -T_sh;
  annotation(Documentation(info = "<html><p>Gerotor or roller gerotor whose rotor orbits; V counts per revolution of the shaft. Oil fed to <code>port_b</code> turns the shaft positively, oil fed to <code>port_a</code> negatively (<code>HydraulicMotor(redeclare OrbitMotor machine)</code> has it the other way round); driven by its load it pumps.</p>
<p><b>Leakage</b> <code>mu_G/mu G (1 + |dp|/p_G) dp</code>: laminar, gaps that the pressure widens.</p>
<p><b>Torque</b> <code>T_loss = (T_0 + k_p D |dp|)(1 + (k_st - 1) exp(-(w/w_st)^2)) sign(w) + b w + D dp_idle w |w|/w_idle^2</code>: mixed friction that falls as the film forms, which makes the starting torque less than the running one, and the pressure drop of channels and distributor, which data sheets give as the idle pressure over the flow. The sign is rounded over <code>w_s</code>, so that a loaded motor creeps within it.</p>
<p>Each loss takes energy in all four quadrants. Below some 10 revolutions per minute ripple counts, which is left out. Sources: mixed friction: form after R. Stribeck, Z. VDI 46 (1902) 1341; leakage and torque: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001. The values are assumed for 200 ml: fit them to the curves of the maker.</p></html>"));
end OrbitMotor;
