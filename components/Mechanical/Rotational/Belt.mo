within Mechanical.Rotational;
model Belt "Elastic belt over two pulleys"
  Interfaces.RotationalFlange flange_a "Driving pulley";
  Interfaces.RotationalFlange flange_b "Driven pulley, turns the same way";
  parameter SI.Radius r_a(min = 1e-4, max = 10, nominal = 0.1) = 0.05 "Radius of the driving pulley";
  parameter SI.Radius r_b(min = 1e-4, max = 10, nominal = 0.1) = 0.1 "Radius of the driven pulley";
  parameter SI.TranslationalSpringConstant c(min = 1e-6, max = 1e12, nominal = 1e5) = 1e5 "Stiffness of both strands together";
  parameter SI.TranslationalDampingConstant d(min = 1e-9, max = 1e10, nominal = 100) = 100 "Damping of both strands together";
  parameter SI.Force F_max(min = 1, max = 1e9, nominal = 1e3) = Modelica.Constants.inf "Force beyond which the belt slips, smoothly";
  SI.Position s_rel(nominal = 1e-3) "Stretch of the pulling strand";
  SI.Force F(nominal = 100) "Force that the belt carries over";
  SI.Velocity v_slip(nominal = 1e-3) "Speed at which the belt slips";
  SI.Power lossPower "Power lost";
protected
  SI.Force F_e(nominal = 100) "Force of spring and damper without slip";
equation
  assert(r_a > 0 and r_b > 0 and c > 0 and d > 0, "Radii, stiffness and damping must be positive");
  der(s_rel) = r_a*der(flange_a.phi) - r_b*der(flange_b.phi) - v_slip;
  F_e = c*s_rel + d*(r_a*der(flange_a.phi) - r_b*der(flange_b.phi));
  if F_max < 1e30 then
    v_slip = (F_e - F)/d;
    F = F_max*tanh(F_e/F_max);
  else
    v_slip = 0;
    F = F_e;
  end if;
  flange_a.tau = r_a*F;
  flange_b.tau = -r_b*F;
  lossPower = F*(r_a*der(flange_a.phi) - r_b*der(flange_b.phi)) - c*s_rel*der(s_rel);
initial equation
  s_rel = 0;
  annotation(Documentation(info = "<html><p><code>F = c s + d ds/dt</code> with the stretch <code>s</code> of the pulling strand, <code>ds/dt = r_a w_a - r_b w_b - v_slip</code>. Force beyond <code>F_max</code> makes the belt creep: the part of the force that is not carried over drives the slip through the damping.
Valid for a pretension above half the load, so that no strand goes slack.</p><p>Source: Dresig and Holzweissig, Dynamics of Machinery, 2010, chapter 4, two strands as one spring.</p></html>"));
end Belt;
