within Electrical;
model SoftStarter "Soft starter: two antiparallel thyristors in each line, whose firing angle falls over time, then a bypass"
  Interfaces.Pin a "Phase a of the mains";
  Interfaces.Pin b "Phase b of the mains";
  Interfaces.Pin c "Phase c of the mains";
  Interfaces.Pin U "Line U to the motor";
  Interfaces.Pin V "Line V to the motor";
  Interfaces.Pin W "Line W to the motor";
  parameter SI.Angle alpha_start(min = 0, max = 5*Modelica.Constants.pi/6, nominal = 1) = 1.9 "Firing angle at the start of the ramp";
  parameter SI.Time t_start(min = 0, max = 1e6, nominal = 1) = 0 "Start of the ramp; no thyristor fires before";
  parameter SI.Time t_ramp(min = 1e-6, max = 1e6, nominal = 1) = 5 "Time in which the firing angle falls to 0";
  parameter SI.Resistance R_on(min = 1e-9, max = 1e3) = 1e-3 "Resistance of a thyristor that conducts";
  parameter SI.Conductance G_off(min = 1e-5, max = 1e3) = 1e-4 "Conductance of a thyristor that blocks";
  parameter SI.Voltage V_knee(min = 0, max = 100) = 0 "Knee voltage of a thyristor; some 1 V";
  parameter SI.Resistance R_bypass(min = 1e-9, max = 1e3) = 1e-4 "Resistance of a contact of the bypass when closed";
  parameter Boolean useInput = false "true: the firing angle follows the input, without ramp" annotation(Evaluate = true);
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.RealInput angle(unit = "rad") if useInput "Firing angle, 0 to 5/6 pi; at 0 the bypass closes";
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the thyristors and contacts";
  SI.Angle alpha(nominal = 1) "Firing angle, after the zero crossing of the voltage of the phase";
  SI.Voltage v[3](each nominal = 100) "Voltages of the phases of the mains against their mean";
  SI.Current i[3](each nominal = 10) "Currents of the lines, to the motor";
  Boolean bypassed "true: the contacts of the bypass are to close";
  SI.Power lossPower(nominal = 10) "Power lost";
  Bases.SoftStarterLine lines[3](each final R_on = R_on, each final G_off = G_off, each final V_knee = V_knee, each final R_bypass = R_bypass) "Thyristors and contact of each line";
protected
  Interfaces.RealInput x(unit = "rad") "Firing angle, in use";
  SI.Voltage q[3](each nominal = 100) "Voltages of the phases, a quarter of a period ahead";
  SI.Voltage v_begin[3](each nominal = 100) "Voltages of the phases, later by alpha";
  SI.Voltage v_end[3](each nominal = 100) "Voltages of the phases, later by beta";
  Boolean started "true: the ramp has begun";
  Boolean on "true: the thyristors are fired";
  Integer sequence(start = 0, fixed = true) "1: phases in the order a, b, c; -1: a, c, b; 0: not known yet";
  constant SI.Angle alpha_max = 5*Modelica.Constants.pi/6 "Firing angle from which no current flows without neutral";
  constant SI.Angle beta = Modelica.Constants.pi/6 "Angle by which the voltage from line to line outlasts that of the phase";
equation
  assert(t_ramp > 0, "The time of the ramp t_ramp must be positive");
  connect(angle, x);
  if not useInput then
    x = alpha_start*(1 - (time - t_start)/t_ramp);
    started = time >= t_start;
    bypassed = time >= t_start + t_ramp;
  else
    started = true;
    bypassed = x <= 0;
  end if;
  alpha = noEvent(min(max(x, 0), if useInput then alpha_max else alpha_start));
  v = {(2*a.v - b.v - c.v)/3, (2*b.v - c.v - a.v)/3, (2*c.v - a.v - b.v)/3};
  when v[1] > 0 then
    sequence = if v[3] > v[2] then 1 else -1;
  end when;
  q = sequence/sqrt(3)*{c.v - b.v, a.v - c.v, b.v - a.v};
  v_begin = v*cos(alpha) - q*sin(alpha);
  v_end = v*cos(beta) - q*sin(beta);
  on = started and sequence <> 0 and not bypassed;
  for j in 1:3 loop
    lines[j].fireForward = on and v_begin[j] > 0 and (alpha < beta or v_end[j] > 0);
    lines[j].fireBackward = on and v_begin[j] < 0 and (alpha < beta or v_end[j] < 0);
    lines[j].bypass = bypassed;
    i[j] = lines[j].i;
  end for;
  connect(a, lines[1].p);
  connect(b, lines[2].p);
  connect(c, lines[3].p);
  connect(lines[1].n, U);
  connect(lines[2].n, V);
  connect(lines[3].n, W);
  lossPower = sum(lines[j].v*lines[j].i for j in 1:3);
  annotation(Documentation(info = "<html><p>A thyristor fires at the angle <code>alpha</code> after the zero crossing of the voltage of its phase and conducts until its current goes to zero; each change is an event. The ramp is <code>alpha = alpha_start (1 - (t - t_start)/t_ramp)</code>; at its end the bypass closes. With <code>useInput</code> the angle comes from outside: a stop by a rising angle, or a controller that limits the current; the ramp itself has no limit of the current. The contacts open at the zero of their current.</p>
<p>Resistors in star, joined to the neutral, get <code>U sqrt(1 - alpha/pi + sin(2 alpha)/(2 pi))</code>. Without neutral the current is zero from 150 degrees on. With a motor an angle below that by which the current lags changes nothing: for the default motor some 60 degrees at standstill, 40 degrees at full load, near 90 degrees without load. So the voltage rises within a part of the ramp only, and not in proportion to the time.</p>
<p>The angle is measured on the voltages at the pins a, b, c, without a filter: for a symmetric sine of any frequency and either order of the phases. The order is known from the first zero crossing on, at most a period after the start; nothing fires before. The gates stay on to the end of the voltage from line to line (210 degrees; below an angle of 30 degrees, for half a period). With the mains not symmetric the angles differ somewhat from <code>alpha</code>. Where a phase is lost it does not trip.</p>
<p>While the thyristors block, the current of a motor dies away with the time <code>2 L G_off</code>, 0.3 microseconds at the defaults; below 1e-5 S it is too short for the integration. The current through a line that blocks is <code>2 G_off</code> times its voltage: some 0.1 A at the mains of 400 V, with its loss. Some 1000 events in a second at 50 or 60 Hz. An inductance between the mains and the pins works, but put a resistor across it (10 to 1000 Ohm), or the run takes ten times as many steps. Losses: <code>R_on i^2 + V_knee |i|</code> in what conducts; passive. Triggering, snubbers and losses of switching are left out.</p>
<p>Source: M. H. Rashid, Power Electronics: Circuits, Devices and Applications, chapter on AC voltage controllers (three-phase full-wave controllers); N. Mohan, T. M. Undeland, W. P. Robbins, Power Electronics, 2003, chapter 14 (induction motors at reduced voltage).</p></html>"));
end SoftStarter;
