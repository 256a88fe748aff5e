within Effects;
model HydraulicCompliance "Further capacity: hose, elastic wall"
  extends Interfaces.HydraulicShunt;
  parameter Real C(unit = "m3/Pa", min = 0, nominal = 3e-14) = 0 "Capacity";
equation
  q = C*der(p);
  annotation(__bramah(family = "extra_compliance", id = "E22", coefficients = {"C"}));
end HydraulicCompliance;
