within Mechanical.Translational.Bases;
partial model Guide "Friction of a slider against the housing: ports and parameters common to all its laws"
  Interfaces.TranslationalFlange flange_a "Left flange";
  Interfaces.TranslationalFlange flange_b "Right flange, moves with the left one";
  parameter SI.Force f_c(min = 0, nominal = 100) = 10 "Coulomb force";
  parameter SI.Force f_s(min = 0, nominal = 100) = f_c "Force of sliding at vanishing speed, at least the Coulomb force";
  parameter SI.Velocity v_s(min = 1e-6, nominal = 1e-2) = 1e-2 "Stribeck speed";
  parameter SI.TranslationalDampingConstant d(min = 0, nominal = 1e3) = 0 "Viscous friction";
  SI.Position s(nominal = 1e-2, start = 0) "Position";
  SI.Velocity v(start = 0, nominal = 0.1) "Velocity";
  SI.Force f "Friction force";
  SI.Power lossPower "Power lost";
equation
  assert(f_c >= 0 and f_s >= f_c, "f_c must not be negative and f_s not below it");
  assert(v_s > 0 and d >= 0, "v_s must be positive, d not negative");
  flange_a.s = s;
  flange_b.s = s;
  v = der(s);
  flange_a.f + flange_b.f - f = 0;
  lossPower = f*v;
end Guide;
