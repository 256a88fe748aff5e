within Mechanical.Rotational;
model BearingFriction "Dry friction of a shaft against the housing, with exact sticking (events)"
  extends Bases.Guide;
  extends Bases.DryFriction;
  parameter Real delta(unit = "1", min = 1, max = 4) = 2 "Exponent of the Stribeck curve: 2 Gauss, 1 Tustin";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Holding torque over that of sliding at vanishing speed";
  parameter Boolean useTable = false "true: the sliding torque follows tau_pos instead of tau_c, tau_s, w_s and d" annotation(Evaluate = true);
  parameter Real tau_pos[:, 2] = [0, 1; 1, 1] "Speed from 0 on, torque of sliding forward; the last segment goes on";
  SI.AngularAcceleration a "Angular acceleration";
equation
  assert(peak >= 1, "peak must be at least 1");
  a = der(w);
  w_slide = w;
  a_slide = a;
  free = false;
  tau_hold = peak*tau_0;
  if useTable then
    assert(size(tau_pos, 1) > 1 and tau_pos[1, 1] == 0, "The table tau_pos needs at least two rows, the first at speed 0");
    for i in 2:size(tau_pos, 1) loop
      assert(tau_pos[i, 1] > tau_pos[i - 1, 1], "The speeds of the table tau_pos must increase");
    end for;
    for i in 1:size(tau_pos, 1) loop
      assert(tau_pos[i, 2] >= 0, "The torques of the table tau_pos must not be negative: friction takes power");
    end for;
    tau_0 = tau_pos[1, 2];
    tau_dry = noEvent(max(Signal.Functions.interpolate(tau_pos, abs(w), false), 0));
    tau_visc = 0;
  else
    tau_0 = tau_s;
    tau_dry = tau_c + (tau_s - tau_c)*exp(-(noEvent(abs(w))/w_s)^delta);
    tau_visc = d*w;
  end if;
  tau = tau_fric;
  annotation(Documentation(info = "<html>
<p>The law of <code>Friction</code> between a shaft and the housing. With <code>useTable</code> the torque of sliding is the table <code>tau_pos</code> over the magnitude of the speed, as in the Modelica Standard Library: straight lines between its points, beyond the last one the last line goes on, never below 0. Interchangeable with <code>SmoothBearingFriction</code> and <code>LuGreBearingFriction</code>.</p></html>"));
end BearingFriction;
