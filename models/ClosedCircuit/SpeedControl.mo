within ClosedCircuit;
model SpeedControl "Speed of the hydraulic motor under a PI controller whose gains follow the quasi-linear form"
  extends Reduced(
    break frequency,
    shaft_1(w(start = 1.07*n_start*Modelica.Constants.pi/30)),
    shaft_2(w(start = n_start*Modelica.Constants.pi/30)),
    highSide(p_start = 11e6),
    redeclare Signal.Step command(height = 3, offset = u, startTime = 20));
  parameter Boolean scheduled = true "true: gains follow the speed; false: those of 27.74 Hz everywhere" annotation(Evaluate = true);
  parameter Real gains[:, 3] = [
    85.4, 0.08014, 0.2444;
    180.7, 0.07752, 0.2355;
    339.8, 0.07594, 0.2306;
    507.0, 0.07561, 0.2300;
    694.3, 0.07581, 0.2312;
    849.3, 0.07619, 0.2329;
    978.6, 0.07659, 0.2347] "Speed in rev/min, gain in Hz per rev/min, gain of the integral in Hz per rev/min and second";
  parameter Real n_start(unit = "rev/min", min = 0, max = 3000) = 694 "Speed at the start";
  parameter SI.Frequency f_max(min = 1, max = 400) = 50 "Highest frequency of the inverter";
  parameter SI.Time T_t(min = 1e-3, max = 100) = 0.33 "Time in which the integral follows the limit";
  replaceable Signal.Step reference(offset = n_start, height = 0, startTime = 10) constrainedby Signal.Bases.Source "Speed asked for, rev/min";
  Signal.Table1D K_p(table = gains[:, {1, 2}]) "Gain over the speed";
  Signal.Table1D K_i(table = gains[:, {1, 3}]) "Gain of the integral over the speed";
  Interfaces.RealOutput f_ref(unit = "Hz", nominal = 10) "Command of the frequency";
  Real e(unit = "rev/min", nominal = 100) "Speed asked for less speed";
  Real x(unit = "Hz", start = 0.04*n_start, nominal = 10) "Integral part of the command";
protected
  Real v(unit = "Hz", start = 0.04*n_start, nominal = 10) "Command before its limits";
initial equation
  if steady then
    der(x) = 0;
  end if;
equation
  K_p.u = if scheduled then n_m else 694.3;
  K_i.u = K_p.u;
  e = reference.y - n_m;
  v = K_p.y*e + x;
  f_ref = homotopy(smooth(0, min(max(v, 0), f_max)), v);
  der(x) = K_i.y*e + (f_ref - v)/T_t;
  connect(f_ref, inverter.f_ref);
  connect(f_ref, synchronous.u);
  annotation(
    experiment(StartTime = 0, StopTime = 40, Interval = 0.005, Tolerance = 1e-7),
    Documentation(info = "<html>
<p>The form linear along operating points (<code>bramah linearize ClosedCircuit.Reduced --inputs f --outputs n_m --set f=..</code>) gives the response from the frequency to the speed at each of the speeds of <code>gains</code>. The controller is laid out in each for a phase margin of 60 degrees
with the zero of the PI at a third of the crossover: where the phase of the circuit is -101.6 degrees, <code>K_p = 1/(|G| sqrt(1 + 1/9))</code> and <code>K_i = K_p w_c/3</code>. The crossover lies at 9.1 to 9.2 rad/s.</p></html>"));
end SpeedControl;
