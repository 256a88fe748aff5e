within Electrical;
model Switch "Switch with small resistance when closed and small conductance when open"
  extends Bases.OnePort;
  parameter SI.Resistance R_on(min = 1e-9, max = 1e6) = 1e-5 "Resistance when closed";
  parameter SI.Conductance G_off(min = 1e-9, max = 1e3) = 1e-5 "Conductance when open";
  Interfaces.BooleanInput closed "true: closed";
protected
  Real s "Voltage over 1 V when open, current over 1 A when closed";
  constant SI.Voltage unit_v = 1;
  constant SI.Current unit_i = 1;
equation
  v = s*unit_v*(if closed then R_on*unit_i/unit_v else 1);
  i = s*unit_i*(if closed then 1 else G_off*unit_v/unit_i);
  annotation(Documentation(info = "<html><p><code>R_on</code> when closed, <code>G_off</code> when open, as one curve with a parameter; switching is an event. No arc, no time of switching.</p></html>"));
end Switch;
