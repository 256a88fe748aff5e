within Effects;
model CommandDeadZone "Small commands do not act"
  extends Interfaces.Command;
  parameter Real k(unit = "1", min = 0, max = 1, nominal = 1) = 0 "Share, 1 for the whole effect";
  parameter Real d(min = 1e-12) = 0.05 "Half the width, in the unit of the input";
  parameter Real w(unit = "1", min = 1e-9) = 0.02 "Width of the corners over half the width of the zone";
equation
  y = u + k*(Smooth.pos(u - d, w*d) - Smooth.pos(-u - d, w*d) - u);
  annotation(__bramah(family = "dead_zone", id = "E11", law = "dead zone", coefficients = {"k"}, shapes(d = {0.03, 0.1, 0.25, 0.5}), relative = {"d"}));
end CommandDeadZone;
