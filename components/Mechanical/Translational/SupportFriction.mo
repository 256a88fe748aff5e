within Mechanical.Translational;
model SupportFriction "Dry friction of a slider against the housing, with sticking"
  extends Bases.DryFriction;
  Interfaces.TranslationalFlange flange_a "Left flange";
  Interfaces.TranslationalFlange flange_b "Right flange, moves with the left one";
  parameter SI.Force f_c(min = 0, nominal = 100) = 10 "Coulomb force";
  parameter SI.Force f_s(min = 0, nominal = 100) = f_c "Force of sliding at vanishing speed, at least the Coulomb force";
  parameter SI.Velocity v_s(min = 1e-9, nominal = 1e-2) = 1e-2 "Stribeck speed";
  parameter Real delta(unit = "1", min = 1, max = 4) = 2 "Exponent of the Stribeck curve: 2 Gauss, 1 Tustin";
  parameter SI.TranslationalDampingConstant d(min = 0, nominal = 1e3) = 0 "Viscous friction";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Holding force over f_s";
  SI.Position s(nominal = 1e-2) "Position";
  SI.Velocity v(start = 0, nominal = 0.1) "Velocity";
  SI.Acceleration a "Acceleration";
  SI.Force f "Friction force";
  SI.Power lossPower "Power lost";
equation
  assert(f_c >= 0 and f_s >= f_c, "f_c must not be negative and f_s not below it");
  assert(v_s > 0 and peak >= 1 and d >= 0, "v_s must be positive, peak at least 1, d not negative");
  flange_a.s = s;
  flange_b.s = s;
  v = der(s);
  a = der(v);
  v_slide = v;
  a_slide = a;
  free = false;
  f_0 = f_s;
  f_hold = peak*f_s;
  f_dry = f_c + (f_s - f_c)*exp(-(noEvent(abs(v))/v_s)^delta);
  f_visc = d*v;
  f = f_fric;
  flange_a.f + flange_b.f - f = 0;
  lossPower = f*v;
  annotation(Documentation(info = "<html>
<p>The law of <code>Friction</code> between a slider and the housing.</p></html>"));
end SupportFriction;
