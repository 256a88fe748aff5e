within Electrical.Bases;
model SoftStarterLine "One line of a soft starter: two antiparallel thyristors and the contact that bypasses them"
  extends OnePort;
  parameter SI.Resistance R_on(min = 1e-9, max = 1e3) = 1e-3 "Resistance of a thyristor that conducts";
  parameter SI.Conductance G_off(min = 1e-5, max = 1e3) = 1e-4 "Conductance of a thyristor that blocks";
  parameter SI.Voltage V_knee(min = 0, max = 100) = 0 "Knee voltage of a thyristor";
  parameter SI.Resistance R_bypass(min = 1e-9, max = 1e3) = 1e-4 "Resistance of the contact when closed";
  Interfaces.BooleanInput fireForward(start = false, fixed = true) "true: current at the gate of the thyristor from p to n";
  Interfaces.BooleanInput fireBackward(start = false, fixed = true) "true: current at the gate of the thyristor from n to p";
  Interfaces.BooleanInput bypass "true: the contact closes; false: it opens at the next zero of the current";
  Boolean offForward(start = true, fixed = true) "true: the thyristor from p to n blocks";
  Boolean offBackward(start = true, fixed = true) "true: the thyristor from n to p blocks";
  Boolean closed(start = false, fixed = true) "true: the contact is closed";
protected
  Boolean ahead(start = false, fixed = true) "true: the current flows from p to n";
  Real s_f "Place on the characteristic of the thyristor from p to n";
  Real s_b "Place on the characteristic of the thyristor from n to p";
  SI.Current i_f(nominal = 10) "Current of the thyristor from p to n";
  SI.Current i_b(nominal = 10) "Current of the thyristor from n to p";
  Real s_c "Place on the characteristic of the contact";
  SI.Current i_c(nominal = 10) "Current of the contact";
  constant SI.Conductance G_c = 1e-9 "Conductance of the contact when open";
  constant SI.Voltage unit_v = 1;
  constant SI.Current unit_i = 1;
equation
  offForward = s_f < 0 or pre(offForward) and not pre(fireForward);
  v = s_f*unit_v*(if offForward then 1 else R_on*unit_i/unit_v) + V_knee;
  i_f = s_f*unit_i*(if offForward then G_off*unit_v/unit_i else 1) + G_off*V_knee;
  offBackward = s_b < 0 or pre(offBackward) and not pre(fireBackward);
  -v = s_b*unit_v*(if offBackward then 1 else R_on*unit_i/unit_v) + V_knee;
  i_b = s_b*unit_i*(if offBackward then G_off*unit_v/unit_i else 1) + G_off*V_knee;
  ahead = i > 0;
  closed = bypass or pre(closed) and ahead == pre(ahead);
  v = s_c*unit_v*(if closed then R_bypass*unit_i/unit_v else 1);
  i_c = s_c*unit_i*(if closed then 1 else G_c*unit_v/unit_i);
  i = i_f - i_b + i_c;
  annotation(Documentation(info = "<html><p>Each thyristor blocks until its gate fires it in forward direction, then conducts until its current goes to zero; two straight lines as in <code>Diode</code>, and an event at each change. The contact opens at a zero of the current, for its arc lasts until then. The voltage at the pins may decide on the gates and depend on the thyristors at once, behind a line with inductance: so a thyristor sees its gate as it was before the event. Without latching and holding current, time of recovery and breakover.</p>
<p>Source: C. Clauss, P. Schneider et al., ideal thyristor of the Modelica Standard Library.</p></html>"));
end SoftStarterLine;
