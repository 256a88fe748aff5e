within Effects;
model ExtraMass "Further inertia"
  extends Interfaces.TranslationalShunt;
  parameter SI.Mass m(min = 0, nominal = 10) = 0 "Inertia";
equation
  f = m*der(v);
  annotation(__bramah(family = "extra_inertia", id = "E12", coefficients = {"m"}));
end ExtraMass;
