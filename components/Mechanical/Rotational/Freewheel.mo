within Mechanical.Rotational;
model Freewheel "Freewheel (one-way clutch): a drives b forward, b may run ahead"
  extends Bases.Compliant;
  parameter SI.Torque tau_drag(min = 0, max = 1e6, nominal = 1) = 0 "Torque of friction while b runs ahead";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  constant Integer Locked = 0 "Mode: both turn together";
  constant Integer Ahead = 1 "Mode: b runs ahead";
  constant Integer Unknown = 3 "Mode: before the first event";
  Integer mode(start = Unknown, fixed = true, min = 0, max = 3) "State of the freewheel";
  Boolean locked(start = false) "true: both turn together";
  SI.AngularVelocity w_rel(start = 0, nominal = 10) "Speed of b relative to a, never negative";
  SI.AngularAcceleration a_rel "Its rate";
  SI.Power lossPower "Power lost";
protected
  constant SI.AngularAcceleration unit_a = 1e3 "Usual size of an acceleration";
  constant SI.Torque unit_f = 1;
  Real path "Place on the characteristic: torque while locked, acceleration beyond it while b runs ahead";
  Real held "The same while locked, else 0, so that no relation on it is crossed while b runs ahead";
  SI.AngularVelocity w_ahead "Speed of b relative to a, 0 while locked, so that no relation on it is crossed by rounding";
  Boolean release(start = false, fixed = true) "true: b begins to run ahead";
equation
  assert(tau_drag >= 0, "The torque tau_drag must not be negative");
  when initial() then
    assert(w_rel > -1e-6, "At the start b must not be slower than a: a freewheel does not let it");
  end when;
  w_rel = der(phi_rel);
  a_rel = der(w_rel);
  held = if pre(mode) == Locked then path else 0;
  w_ahead = if pre(mode) == Locked and not release then 0 else w_rel;
  release = pre(mode) == Locked and held > tau_drag/unit_f or initial() and w_ahead > 0;
  locked = not (pre(mode) == Ahead or release);
  a_rel/unit_a = if locked then 0 else path - tau_drag/unit_f;
  tau = if locked then unit_f*path else tau_drag;
  mode = if (pre(mode) == Ahead or release) and w_ahead > 0 then Ahead else Locked;
  lossPower = tau*w_rel;
  annotation(Documentation(info = "<html><p>Locked, both turn together and a drives b with any torque, <code>tau</code> not above <code>tau_drag</code>; when b wants to run ahead with more than that, it is let go and <code>tau = tau_drag</code>; it locks again when the speeds are equal, <code>w_rel = 0</code>, so without impact. No energy is gained: <code>tau*w_rel</code> is zero while locked and <code>tau_drag*w_rel</code> while b runs ahead.</p>
<p>Locking and letting go are events on one curve of torque and acceleration, as in <code>Clutch</code>. Windup of the rollers or sprags and the play of a ratchet are left out: put a <code>SpringDamper</code> or <code>ElastoBacklash</code> in series. Each flange needs something with inertia. Source: M. Otter, H. Elmqvist, S. E. Mattsson, CACSD 1999, for the curve.</p></html>"));
end Freewheel;
