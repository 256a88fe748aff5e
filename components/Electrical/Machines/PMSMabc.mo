within Electrical.Machines;
model PMSMabc "Permanent magnet synchronous motor in phases, star point free"
  Interfaces.Pin a "Phase a";
  Interfaces.Pin b "Phase b";
  Interfaces.Pin c "Phase c";
  Interfaces.RotationalFlange flange "Shaft; the inertia of the rotor is a component of its own";
  parameter Integer p(min = 1, max = 100) = 8 "Pole pairs";
  parameter SI.MagneticFlux psi_f(min = 1e-6, max = 100, nominal = 0.1) = 0.08 "Flux linkage of the magnets, peak";
  parameter SI.Resistance R_s(min = 0, max = 1e3, nominal = 1) = 0.176 "Phase resistance";
  parameter SI.Inductance L_d(min = 1e-9, max = 10, nominal = 1e-3) = 0.314e-3 "Inductance of the d axis";
  parameter SI.Inductance L_q(min = 1e-9, max = 10, nominal = 1e-3) = 0.314e-3 "Inductance of the q axis";
  parameter SI.Inductance L_ls(min = 0, max = 10, nominal = 1e-4) = 0.05e-3 "Leakage inductance; without effect while the star point is free";
  SI.AngularVelocity w(nominal = 100) "Speed";
  SI.Angle theta "Electrical angle";
  SI.Current i_d(start = 0, fixed = true) "Current of the d axis";
  SI.Current i_q(start = 0, fixed = true) "Current of the q axis";
  SI.Current i[3] "Currents of the phases";
  SI.Voltage v[3] "Voltages of the phases against the star point";
  SI.Torque T_e "Electromagnetic torque";
protected
  constant SI.Angle third = 2*Modelica.Constants.pi/3;
  parameter SI.Inductance L_A = (L_d + L_q - 2*L_ls)/3 "Mean magnetizing inductance of a phase";
  parameter SI.Inductance L_B = (L_d - L_q)/3 "Amplitude of its change";
  SI.MagneticFlux psi[3] "Flux linkages of the phases";
  SI.Voltage v_star "Potential of the star point";
equation
  assert(p >= 1, "The number of pole pairs p must be at least 1");
  w = der(flange.phi);
  theta = p*flange.phi;
  a.i = i[1];
  b.i = i[2];
  c.i = i[3];
  v[1] = a.v - v_star;
  v[2] = b.v - v_star;
  v[3] = c.v - v_star;
  for j in 1:3 loop
    i[j] = i_d*cos(theta - (j - 1)*third) - i_q*sin(theta - (j - 1)*third);
    psi[j] = (L_ls + 1.5*L_A)*i[j] + L_B*sum(cos(2*theta - (j + k - 2)*third)*i[k] for k in 1:3) + psi_f*cos(theta - (j - 1)*third);
    v[j] = R_s*i[j] + der(psi[j]);
  end for;
  T_e = -p*(psi_f*sum(sin(theta - (j - 1)*third)*i[j] for j in 1:3) + L_B*sum(sum(sin(2*theta - (j + k - 2)*third)*i[k]*i[j] for k in 1:3) for j in 1:3));
  flange.tau = -T_e;
  annotation(Documentation(info = "<html><p><code>v = R_s i + d psi/dt</code> in phases, <code>psi = L(theta) i + psi_f(theta)</code> with <code>L_jj = L_ls + L_A + L_B cos(2 theta - 2 j 2pi/3)</code> and <code>L_jk = -L_A/2 + L_B cos(2 theta - (j + k) 2pi/3)</code>, j and k from 0;
with currents that sum to zero the constant part is <code>(L_ls + 3/2 L_A) i_j</code>. The two independent currents are given in rotor axes. Source: Zhang et al., Processes 2021, 9, 814, section 3.1; P. C. Krause, Analysis of Electric Machinery. Saturation, iron loss and heat are left out: they are in <code>PMSM</code>.</p></html>"));
end PMSMabc;
