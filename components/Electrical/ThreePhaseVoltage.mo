within Electrical;
model ThreePhaseVoltage "Three sine voltages in star, of given frequency and amplitude"
  Interfaces.Pin a "Phase a";
  Interfaces.Pin b "Phase b";
  Interfaces.Pin c "Phase c";
  Interfaces.Pin neutral "Star point";
  parameter SI.Voltage U(min = 0, max = 1e6, nominal = 100) = 230 "Voltage of a phase, rms";
  parameter SI.Frequency f(min = 0, max = 1e4, nominal = 50) = 50 "Frequency";
  parameter Boolean useInput = false "true: scale follows the input, as of a soft starter or a sag" annotation(Evaluate = true);
  parameter Real phases[3](each unit = "1", each min = 0, each max = 10) = {1, 1, 1} "Voltage of each phase over U: 0 is a phase without voltage";
  Interfaces.RealInput scale(unit = "1") if useInput "Voltage over U, 0 to 1";
  SI.Voltage v[3](each nominal = 100) "Voltages of the phases against the star point";
  SI.Current i[3](each nominal = 10) "Currents out of the phases";
  SI.Power power(nominal = 1e3) "Power given";
protected
  Interfaces.RealInput k(unit = "1") "Voltage over U, in use";
  constant SI.Angle third = 2*Modelica.Constants.pi/3;
equation
  connect(scale, k);
  if not useInput then
    k = 1;
  end if;
  for j in 1:3 loop
    v[j] = sqrt(2)*U*k*phases[j]*cos(2*Modelica.Constants.pi*f*time - (j - 1)*third);
  end for;
  v = {a.v - neutral.v, b.v - neutral.v, c.v - neutral.v};
  i = {-a.i, -b.i, -c.i};
  neutral.i = i[1] + i[2] + i[3];
  power = v*i;
  annotation(Documentation(info = "<html><p><code>v_j = sqrt(2) U k_j scale cos(2 pi f t - 2 pi (j - 1)/3)</code>. A soft starter raises <code>scale</code> from some 0.3 to 1 (its mean over the firing angle; the notches of its thyristors are left out); <code>phases</code> makes a supply that is not symmetric. Join <code>neutral</code> to a ground.</p></html>"));
end ThreePhaseVoltage;
