within Effects;
model InverterDrop "Voltage that an inverter loses against the current"
  extends Interfaces.ElectricalSeries;
  parameter SI.Voltage V_d(min = 0, nominal = 3) = 0 "Voltage lost";
  parameter SI.Current i_s(min = 1e-9) = 0.2 "Current over which it changes sign";
equation
  v = V_d*tanh(i/i_s);
  annotation(__bramah(family = "dead_zone", id = "E09", coefficients = {"V_d"}, shapes(i_s = {0.2})));
end InverterDrop;
