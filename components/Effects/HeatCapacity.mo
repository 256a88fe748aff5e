within Effects;
model HeatCapacity "Further heat capacity"
  extends Interfaces.ThermalShunt;
  parameter SI.HeatCapacity C(min = 0, nominal = 100) = 0 "Heat capacity";
equation
  Q_flow = C*der(T);
  annotation(__bramah(family = "extra_compliance", id = "E30", coefficients = {"C"}));
end HeatCapacity;
