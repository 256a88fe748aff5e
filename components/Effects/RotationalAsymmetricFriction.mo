within Effects;
model RotationalAsymmetricFriction "Viscous friction that differs by direction"
  extends Interfaces.RotationalShunt;
  parameter Real d(unit = "N.m.s/rad", nominal = 0.003) = 0 "Half the difference of the dampings";
  parameter SI.AngularVelocity v_c(min = 1e-9) = 0.5 "Width of the corner";
equation
  tau = d*Smooth.mag(w, v_c);
  annotation(__bramah(family = "viscous_friction", id = "E27", coefficients = {"d"}));
end RotationalAsymmetricFriction;
