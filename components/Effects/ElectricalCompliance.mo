within Effects;
model ElectricalCompliance "Further capacitance to ground"
  extends Interfaces.ElectricalShunt;
  parameter SI.Capacitance C(min = 0, nominal = 1e-6) = 0 "Capacitance";
equation
  i = C*der(v);
  annotation(__bramah(family = "extra_compliance", id = "E22", coefficients = {"C"}));
end ElectricalCompliance;
