within Hydraulic;
model DryResistance "Constant pressure difference against the flow, as by a piston with dry friction"
  extends Bases.TwoPort;
  parameter SI.Pressure dp_friction(min = 0, nominal = 1e5) = 1e5 "Pressure difference";
  parameter SI.VolumeFlowRate q_w(min = 1e-9, nominal = 1e-5) = 1e-6 "Flow over which it changes sign";
equation
  assert(dp_friction >= 0, "dp_friction must not be negative");
  dp = dp_friction*Smooth.sgn(q, q_w);
  annotation(Documentation(info = "<html><p><code>dp = dp_friction sign(q)</code>: the seal friction of a separating piston. Between ports that are both held at given pressures it has no solution. Valid for motion; at rest it creeps within <code>q_w</code> instead of holding.</p></html>"));
end DryResistance;
