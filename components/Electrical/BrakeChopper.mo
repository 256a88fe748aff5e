within Electrical;
model BrakeChopper "Brake resistor across a DC link, switched on above a voltage"
  extends Bases.OnePort;
  parameter SI.Resistance R(min = 1e-3, max = 1e6, nominal = 20) = 20 "Brake resistor";
  parameter SI.Voltage V_on(min = 1e-3, max = 1e6, nominal = 700) = 720 "Voltage above which the resistor is switched on";
  parameter SI.Voltage V_off(min = 0, max = 1e6, nominal = 700) = 690 "Voltage below which it is switched off";
  parameter Boolean averaged = false "true: mean over the switching, without events" annotation(Evaluate = true);
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the resistor";
  Real duty(unit = "1") "Part of the time for which the resistor is on; 0 or 1 where it is switched";
  SI.Power lossPower(nominal = 1e3) "Power of the resistor";
  SI.Energy energy(start = 0, fixed = true, nominal = 1e3) "Energy taken so far";
  Signal.Hysteresis switch(final uLow = V_off, final uHigh = V_on) if not averaged "Switch";
protected
  Interfaces.RealInput u "Voltage that switches";
  Interfaces.BooleanInput on "true: on, where it is switched";
  constant Real w(unit = "1") = 0.1 "Rounding of the averaged duty over V_on - V_off";
equation
  assert(R > 0, "The resistance R must be positive");
  assert(V_on > V_off, "The chopper must switch on at a higher voltage than off: V_on above V_off");
  u = v;
  connect(u, switch.u);
  connect(switch.y, on);
  if averaged then
    on = false;
    duty = Smooth.clip((v - V_off)/(V_on - V_off), w);
  else
    duty = if on then 1 else 0;
  end if;
  i = duty*v/R;
  lossPower = v*i;
  der(energy) = lossPower;
  annotation(Documentation(info = "<html><p>On above <code>V_on</code>, off below <code>V_off</code>, each an event: <code>i = v/R</code> while on. Averaged: the duty rises from 0 at <code>V_off</code> to 1 at <code>V_on</code>, its corners rounded over a tenth of <code>V_on - V_off</code>, so that the link settles where the resistor takes what comes in; valid for processes slower than the switching. Off at the start. Passive. The greatest power is <code>V_on^2/R</code>: what comes in above it raises the link further.</p>
<p>Source: N. Mohan, T. M. Undeland, W. P. Robbins, Power Electronics, 2003, section 14-2 (dissipative braking).</p></html>"));
end BrakeChopper;
