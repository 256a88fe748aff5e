within Effects;
model TranslationalAsymmetricFriction "Viscous friction that differs by direction"
  extends Interfaces.TranslationalShunt;
  parameter Real d(unit = "N.s/m", nominal = 100) = 0 "Half the difference of the dampings";
  parameter SI.Velocity v_c(min = 1e-9) = 0.003 "Width of the corner";
equation
  f = d*Smooth.mag(v, v_c);
  annotation(__bramah(family = "viscous_friction", id = "E27", coefficients = {"d"}));
end TranslationalAsymmetricFriction;
