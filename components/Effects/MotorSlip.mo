within Effects;
model MotorSlip "The shaft falls behind under load"
  extends Interfaces.RotationalSeries;
  parameter Real s(unit = "rad/(N.m.s)", min = 0, nominal = 0.5) = 0 "Speed lost over the torque";
equation
  der(phi_rel) = s*tau;
  annotation(__bramah(family = "slip", id = "E13", coefficients = {"s"}));
end MotorSlip;
