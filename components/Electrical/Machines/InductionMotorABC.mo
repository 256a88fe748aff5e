within Electrical.Machines;
model InductionMotorABC "Induction motor in phases, both ends of each winding led out"
  Interfaces.Pin U1 "Begin of winding U";
  Interfaces.Pin V1 "Begin of winding V";
  Interfaces.Pin W1 "Begin of winding W";
  Interfaces.Pin U2 "End of winding U";
  Interfaces.Pin V2 "End of winding V";
  Interfaces.Pin W2 "End of winding W";
  Interfaces.RotationalFlange flange "Shaft; the inertia of the rotor is a component of its own";
  parameter Integer p(min = 1, max = 100) = 2 "Pole pairs";
  parameter SI.Resistance R_s(min = 1e-6, max = 1e3, nominal = 0.1) = 0.087 "Resistance of a winding of the stator at T_ref";
  parameter SI.Resistance R_r(min = 1e-6, max = 1e3, nominal = 0.1) = 0.228 "Rotor resistance at T_ref, on the stator side";
  parameter SI.Inductance L_ls(min = 1e-9, max = 10, nominal = 1e-3) = 0.302/(120*Modelica.Constants.pi) "Leakage inductance of the stator";
  parameter SI.Inductance L_lr(min = 1e-9, max = 10, nominal = 1e-3) = 0.302/(120*Modelica.Constants.pi) "Leakage inductance of the rotor, on the stator side";
  parameter SI.Inductance L_m(min = 1e-9, max = 100, nominal = 1e-2) = 13.08/(120*Modelica.Constants.pi) "Magnetizing inductance";
  parameter Real unbalance[3](each unit = "1", each min = -0.9, each max = 10) = {0, 0, 0} "Resistances of the windings above R_s, over R_s";
  parameter SI.RotationalDampingConstant B(min = 0) = 0 "Friction and windage";
  parameter SI.Temperature T_ref(min = 200, max = 500) = 293.15 "Temperature of R_s and R_r";
  parameter SI.TemperatureDifference dT(min = -200, max = 300) = 0 "Windings above T_ref, without heatPort";
  parameter SI.LinearTemperatureCoefficient alpha(min = 0, max = 0.02) = 0.0039 "Temperature coefficient of the resistances";
  parameter Boolean useHeatPort = false "true: temperature and losses go through heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(T = T_w, Q_flow = -P_cu) if useHeatPort "Windings";
  SI.AngularVelocity w(nominal = 100) "Speed";
  SI.Current i[3](each nominal = 10) "Currents of the windings, from begin to end";
  SI.Voltage v[3](each nominal = 100) "Voltages of the windings";
  SI.Current i_0(start = 0, fixed = true, nominal = 10) "Current of the zero sequence";
  SI.MagneticFlux psi_as(start = 0, fixed = true) "Flux of the stator along winding U";
  SI.MagneticFlux psi_bs(start = 0, fixed = true) "Flux of the stator across winding U";
  SI.MagneticFlux psi_ar(start = 0, fixed = true) "Flux of the rotor along winding U";
  SI.MagneticFlux psi_br(start = 0, fixed = true) "Flux of the rotor across winding U";
  SI.Current i_ar(nominal = 10) "Rotor current along winding U";
  SI.Current i_br(nominal = 10) "Rotor current across winding U";
  SI.Torque T_e(nominal = 100) "Electromagnetic torque";
  SI.Power P_cu(nominal = 100) "Copper loss of stator and rotor";
  SI.Temperature T_w(nominal = 300) "Temperature of the windings";
protected
  parameter SI.Inductance L_s = L_ls + L_m "Inductance of the stator";
  parameter SI.Inductance L_r = L_lr + L_m "Inductance of the rotor";
  SI.Current i_as(nominal = 10) "Stator current along winding U";
  SI.Current i_bs(nominal = 10) "Stator current across winding U";
  SI.Voltage d_as(nominal = 100) "Rate of psi_as";
  SI.Voltage d_bs(nominal = 100) "Rate of psi_bs";
  SI.Voltage d_0 "Rate of the flux of the zero sequence";
  Real heat(unit = "1") "Resistances over those at T_ref";
equation
  assert(p >= 1, "The number of pole pairs p must be at least 1");
  assert(R_r > 0 and L_m > 0 and L_ls > 0 and L_lr > 0, "Rotor resistance and inductances must be positive");
  assert(heat > 0, "Cold windings keep some resistance: alpha holds near T_ref only");
  if not useHeatPort then
    T_w = T_ref + dT;
  end if;
  heat = 1 + alpha*(T_w - T_ref);
  w = der(flange.phi);
  {U1.i, V1.i, W1.i} = i;
  {U2.i, V2.i, W2.i} = -i;
  v = {U1.v - U2.v, V1.v - V2.v, W1.v - W2.v};
  i_as = (2*i[1] - i[2] - i[3])/3;
  i_bs = (i[2] - i[3])/sqrt(3);
  3*i_0 = i[1] + i[2] + i[3];
  psi_as = L_s*i_as + L_m*i_ar;
  psi_bs = L_s*i_bs + L_m*i_br;
  psi_ar = L_r*i_ar + L_m*i_as;
  psi_br = L_r*i_br + L_m*i_bs;
  d_as = der(psi_as);
  d_bs = der(psi_bs);
  d_0 = L_ls*der(i_0);
  v[1] = R_s*heat*(1 + unbalance[1])*i[1] + d_as + d_0;
  v[2] = R_s*heat*(1 + unbalance[2])*i[2] - d_as/2 + sqrt(3)/2*d_bs + d_0;
  v[3] = R_s*heat*(1 + unbalance[3])*i[3] - d_as/2 - sqrt(3)/2*d_bs + d_0;
  der(psi_ar) = -R_r*heat*i_ar - p*w*psi_br;
  der(psi_br) = -R_r*heat*i_br + p*w*psi_ar;
  T_e = 1.5*p*(psi_as*i_bs - psi_bs*i_as);
  P_cu = R_s*heat*((1 + unbalance[1])*i[1]^2 + (1 + unbalance[2])*i[2]^2 + (1 + unbalance[3])*i[3]^2) + 1.5*R_r*heat*(i_ar^2 + i_br^2);
  flange.tau = -T_e + B*w;
  annotation(Documentation(info = "<html>
<p>Windings and rotor in axes that stand still, along and across winding U: <code>v_k = R_s i_k + d psi_k/dt</code>, the zero sequence by the leakage alone, <code>0 = R_r i_r + d psi_r/dt - j p w psi_r</code>, <code>T_e = 3/2 p (psi_as i_bs - psi_bs i_as)</code>. Both ends of each winding are led out: joined at U2, V2, W2 it is a star (with the neutral led out or not), U2 to V1, V2 to W1, W2 to U1 a delta. A line that opens, a winding with more resistance (<code>unbalance</code>), a supply that is not symmetric: all go through the pins. In steady state with a symmetric supply equal to <code>InductionMotor</code>.</p>
<p>A star without neutral has no zero sequence: <code>i_0</code> is no state then. Where a switch cuts a winding off, it must leave some conductance, for the flux cannot jump.</p>
<p>Defaults: 50 hp, 460 V, 60 Hz, four poles. Source: P. C. Krause, Analysis of Electric Machinery, chapters 3 and 4. Saturation, iron loss and harmonics are left out.</p></html>"));
end InductionMotorABC;
