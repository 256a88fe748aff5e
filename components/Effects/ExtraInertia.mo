within Effects;
model ExtraInertia "Further inertia"
  extends Interfaces.RotationalShunt;
  parameter SI.Inertia J(min = 0, nominal = 0.001) = 0 "Inertia";
equation
  tau = J*der(w);
  annotation(__bramah(family = "extra_inertia", id = "E12", coefficients = {"J"}));
end ExtraInertia;
