within Mechanical.Translational.Bases;
partial model DryFriction "Dry friction as an automaton with the states stuck, sliding forward, sliding backward and free"
  parameter SI.Velocity v_small(min = 1e-6) = 1e10 "Sliding speed above which a reversal counts as a jump; lower it only where reinit changes the speed";
  constant Integer Backward = -1 "Mode: sliding backward";
  constant Integer Stuck = 0 "Mode: held, no motion";
  constant Integer Forward = 1 "Mode: sliding forward";
  constant Integer Free = 2 "Mode: no contact";
  constant Integer Unknown = 3 "Mode: before the first event";
  Integer mode(start = Unknown, fixed = true, min = -1, max = 3) "State of the contact";
  Boolean locked(start = false) "true: held";
protected
  constant SI.Acceleration unit_a = 1;
  constant SI.Force unit_f = 1;
  SI.Velocity v_slide "Sliding speed";
  SI.Acceleration a_slide "Its rate";
  SI.Force f_hold(min = 0) "Largest force that the contact holds";
  SI.Force f_0(min = 0) "Force of sliding at vanishing speed";
  SI.Force f_dry "Magnitude of the dry part while sliding";
  SI.Force f_visc "Viscous part while sliding";
  SI.Force f_fric "Friction force, against the motion when positive and sliding forward";
  Boolean free "true: no contact";
  Real path "Place on the characteristic: force while stuck, acceleration beyond it while sliding";
  Real held "The same while stuck, else 0, so that no relation on it is crossed while sliding";
  SI.Velocity v_moving "Sliding speed, 0 while stuck, so that no relation on it is crossed by rounding";
  Boolean startForward(start = false, fixed = true) "true: begins to slide forward";
  Boolean startBackward(start = false, fixed = true) "true: begins to slide backward";
  Boolean forward "true: slides forward, or begins to";
equation
  held = if pre(mode) == Stuck then path else 0;
  v_moving = if pre(mode) == Stuck and not startForward and not startBackward then 0 else v_slide;
  startForward = pre(mode) == Stuck and (held > f_hold/unit_f or pre(startForward) and held > f_0/unit_f)
    or pre(mode) == Backward and v_moving > v_small
    or initial() and v_moving > 0;
  startBackward = pre(mode) == Stuck and (held < -f_hold/unit_f or pre(startBackward) and held < -f_0/unit_f)
    or pre(mode) == Forward and v_moving < -v_small
    or initial() and v_moving < 0;
  locked = not free and not (pre(mode) == Forward or startForward or pre(mode) == Backward or startBackward);
  forward = startForward or pre(mode) == Forward and not startBackward;
  a_slide/unit_a = if locked then 0 elseif free then path elseif forward then path - f_hold/unit_f else path + f_hold/unit_f;
  f_fric = if locked then unit_f*path elseif free then 0 elseif forward then f_dry + f_visc else f_visc - f_dry;
  mode = if free then Free
    elseif (pre(mode) == Forward or pre(mode) == Free or startForward) and v_moving > 0 then Forward
    elseif (pre(mode) == Backward or pre(mode) == Free or startBackward) and v_moving < 0 then Backward
    else Stuck;
  annotation(Documentation(info = "<html>
<p>A component that extends this gives the sliding speed and its rate, the greatest holding force <code>f_hold</code>, the sliding force at zero speed <code>f_0</code> and over speed
(<code>f_dry</code>, <code>f_visc</code>), and <code>free</code>.</p>
<p>Friction force and acceleration are one curve with the parameter <code>path</code>: stuck, the acceleration is zero and <code>path</code> is the force; beyond the holding limit the contact slides and <code>path</code> runs on with the
acceleration. The relations on <code>path</code> and on the speed are events, so that sticking begins and ends exactly, without creep and without chatter, also where several contacts act on each other: the modes and the accelerations are then solved together at the event.</p>
<p>Source: M. Otter, H. Elmqvist, S. E. Mattsson, Hybrid modeling in Modelica based on the synchronous data flow principle, CACSD 1999.</p></html>"));
end DryFriction;
