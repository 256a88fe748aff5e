within Hydraulic;
model DoubleRodCylinder "Double-acting cylinder with a rod on both sides: equal areas"
  extends Cylinder(A_1 = 37.70e-4, final A_2 = A_1);
  Interfaces.TranslationalFlange flange_2 "Rod on the side of chamber 1; moves with flange";
  LaminarGap rodLeak_1(G = C_e, mu_G = mu_C, followViscosity = followViscosity) if rodLeakage "Leakage past the rod on the side of chamber 1";
equation
  connect(port_1, rodLeak_1.port_a);
  connect(rodLeak_1.port_b, outside.port);
  connect(piston.flange_a, flange_2);
  annotation(Documentation(info = "<html>
<p>A <code>Cylinder</code> whose chamber 2 has the area of chamber 1, <code>A_1 = pi/4 (D^2 - d^2)</code>: both directions have the same force and the same speed, and the surroundings press on both rods alike,
<code>m dv/dt = A_1 (p_1 - p_2) - f + f_flange + f_flange_2</code>. The cylinder of servo axes and steering. With <code>rodLeakage</code> both rods leak.</p>
<p>Defaults: bore 80 mm, rods 40 mm, stroke 180 mm. <code>m</code> counts both rods. Valid as <code>Cylinder</code>. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 6.2.</p></html>"));
end DoubleRodCylinder;
