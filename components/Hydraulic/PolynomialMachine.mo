within Hydraulic;
model PolynomialMachine "Displacement machine with losses as polynomials in pressure, speed and displacement"
  extends Bases.Machine(compression = false);
  parameter SI.Pressure p_nom(min = 1e5, nominal = 1e7) = 2e7 "Pressure to which the coefficients refer";
  parameter SI.AngularVelocity w_nom(min = 1, nominal = 100) = 157 "Speed to which the coefficients refer";
  parameter Real q_1(unit = "1", min = 0) = 0.02 "Leakage over pressure, as part of V n at the nominal point";
  parameter Real q_2(unit = "1", min = 0) = 0.005 "Leakage over the square of pressure";
  parameter Real q_3(unit = "1", min = 0) = 0.01 "Leakage over pressure times speed";
  parameter Real q_4(unit = "1", min = 0) = 0 "Leakage over pressure times the square of the displacement";
  parameter Real m_0(unit = "1", min = 0) = 0.005 "Constant torque loss, as part of the ideal torque at the nominal point";
  parameter Real m_1(unit = "1", min = 0) = 0.02 "Torque loss over pressure";
  parameter Real m_2(unit = "1", min = 0) = 0.01 "Torque loss over speed";
  parameter Real m_3(unit = "1", min = 0) = 0.005 "Torque loss over the square of speed";
  parameter Real m_4(unit = "1", min = 0) = 0 "Torque loss over pressure times displacement";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed";
protected
  Real x(unit = "1") "Magnitude of pressure over p_nom";
  Real y(unit = "1") "Magnitude of speed over w_nom";
equation
  assert(q_1 >= 0 and q_2 >= 0 and q_3 >= 0 and q_4 >= 0, "Coefficients of leakage must not be negative");
  assert(m_0 >= 0 and m_1 >= 0 and m_2 >= 0 and m_3 >= 0 and m_4 >= 0, "Coefficients of torque loss must not be negative");
  x = Smooth.mag(dp, 1e4)/p_nom;
  y = Smooth.mag(w, 1e-2)/w_nom;
  Q_leak = D*w_nom*(q_1 + q_2*x + q_3*y + q_4*u_used^2)*dp/p_nom;
  T_loss = D*p_nom*((m_0 + m_1*x + m_4*x*abs(u_used))*Smooth.sgn(w, w_s) + (m_2 + m_3*y)*w/w_nom);
  annotation(Documentation(info = "<html>
<p>With pressure and speed over their nominal values: leakage <code>V n_nom (q_1 x + q_2 x^2 + q_3 x y + q_4 x u^2)</code>, torque loss <code>D p_nom (m_0 + m_1 x + m_2 y + m_3 y^2 + m_4 x u)</code>. Each term takes energy in all four quadrants, which free polynomials fitted to a map do not.</p>
<p>Fit the coefficients to measured losses by least squares with non-negative coefficients; valid within the measured range. Source: polynomials in pressure, speed and displacement as L. Zarotti and N. Nevegato, Pump efficiencies: approximation and modelling, 6th Int. Fluid Power Symposium 1981, introduced them. Their paper was not at hand: which terms they keep may differ from these, of which every one is passive.</p></html>"));
end PolynomialMachine;
