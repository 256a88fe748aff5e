within Oil;
package Heat "Heat that oil carries"
  annotation(Documentation(info = "<html>
<p>The volume of oil grows linearly with its temperature, <code>v = v_0(p) (1 + gamma (T - T_0))</code>, so that with <code>dh = c_p dT + (v - T dv/dT) dp</code> the
enthalpy is <code>h = c_p (T - T_0) + (1 - gamma T_0) w(p) = c_p (T - T_0 + throttling(p))</code>, <code>w</code> being the integral of <code>v_0 dp</code> that the law of compression gives, and <code>c_p</code> does not depend on the pressure.
Source: H. D. Baehr and S. Kabelac, Thermodynamik, Springer 2016.</p></html>"));
end Heat;
