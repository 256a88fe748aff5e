within Effects;
model LineInertance "Inertia and friction of the oil in a line"
  extends Interfaces.HydraulicSeries;
  parameter Real L(unit = "Pa.s2/m3", min = 0, nominal = 2e6) = 0 "Inertance";
  parameter Real R(unit = "Pa.s/m3", min = 0, nominal = 2e8) = 0 "Resistance";
equation
  dp = L*der(q) + R*q;
  annotation(__bramah(family = "line_inertance", id = "E25", coefficients = {"L", "R"}));
end LineInertance;
