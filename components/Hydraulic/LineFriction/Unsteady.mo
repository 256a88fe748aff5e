within Hydraulic.LineFriction;
model Unsteady "Friction that grows with the frequency: the past of the flow, weighted"
  extends Law(
    final added = 4*sum(weight[i]/rate[i] for i in k + 1:10));
  parameter Integer k(min = 1, max = 10) = 6 "Terms of the weighting function, a state each";
  Real z[k](each unit = "kg/s", each nominal = 0.1) "Weighted past of the mass flow";
protected
  constant Real rate[10](each unit = "1") = {26.3744, 72.8033, 187.424, 536.626, 1570.60, 4618.13, 13601.1, 40082.5, 118153, 348316} "Rates of the terms, in nu/R^2";
  constant Real weight[10](each unit = "1") = {1, 1.16725, 2.20064, 3.92861, 6.78788, 11.6761, 20.0612, 34.4541, 59.1642, 101.590} "Weights of the terms";
  Real s(unit = "1/s", nominal = 1) "Viscosity over the square of the radius";
initial equation
  for i in 1:k loop
    z[i] = weight[i]*m_flow;
  end for;
equation
  s = 4*mu/(rho*d^2);
  for i in 1:k loop
    der(z[i]) = rate[i]*s*(weight[i]*m_flow - z[i]);
  end for;
  dp = Functions.pipeFriction(m_flow, L, d, rho, mu)
    + 64*mu*L/(Modelica.Constants.pi*d^4*rho)*sum(weight[i]*m_flow - z[i] for i in 1:k);
  annotation(Documentation(info = "<html>
<p>In laminar flow the drop is <code>R q + (R/2) integral of W(t - s) dq/ds ds</code> with <code>R = 128 mu L/(pi d^4)</code>: what accelerates leaves the wall behind. The weighting function is a sum of exponentials, <code>W = sum of m_i exp(-n_i nu t/R_0^2)</code>, each a state, <code>dz_i/dt = n_i nu/R_0^2 (m_i q - z_i)</code>, and the integral is the sum of <code>m_i q - z_i</code>;
no derivative of the flow is needed, and every term takes energy. A steady flow does not notice the law. It starts as if the flow had been steady before.</p>
<p>Ten terms meet the impedance of laminar flow within 0.2 % up to <code>w R_0^2/nu</code> of 400 and further; of <code>k</code> terms the last reaches to about a quarter of its rate: with six, to 1200 (2.2e3 rad/s at 46 mm2/s and 10 mm). What the omitted terms add to the inertia at lower frequencies is kept as <code>added</code>.</p>
<p>Limits: laminar flow of little compression in a straight round pipe. In turbulent flow the steady part is Blasius', but the memory is shorter than here, and waves are damped too much.</p>
<p>Sources: W. Zielke, J. Basic Eng. 90 (1968) 109; sum of exponentials: A. K. Trikha, J. Fluids Eng. 97 (1975) 97; coefficients: T. Kagawa et al., Trans. JSME B 49 (1983) 2638.</p></html>"));
end Unsteady;
