within Electrical;
model Diode "Ideal diode with knee voltage, exact switching"
  extends Bases.OnePort;
  parameter SI.Resistance R_on(min = 1e-9, max = 1e6) = 1e-5 "Resistance in forward direction";
  parameter SI.Conductance G_off(min = 1e-9, max = 1e3) = 1e-5 "Conductance in backward direction";
  parameter SI.Voltage V_knee(min = 0) = 0 "Knee voltage";
  Boolean off(start = true) "true: blocks";
protected
  Real s "Place on the characteristic";
  constant SI.Voltage unit_v = 1;
  constant SI.Current unit_i = 1;
equation
  off = s < 0;
  v = s*unit_v*(if off then 1 else R_on*unit_i/unit_v) + V_knee;
  i = s*unit_i*(if off then G_off*unit_v/unit_i else 1) + G_off*V_knee;
  annotation(Documentation(info = "<html><p>Two straight lines, <code>R_on</code> and <code>G_off</code>, that meet at the knee voltage; the change over is an event, also where several diodes switch together. Valid for currents far above <code>G_off</code> times the voltage. Source: C. Clauss, P. Schneider et al., ideal diode of the Modelica Standard Library.</p></html>"));
end Diode;
