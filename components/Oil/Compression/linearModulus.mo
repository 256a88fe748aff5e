within Oil.Compression;
function linearModulus "Bulk modulus linear in pressure: rho = rho_0 (1 + m (p - p_0)/beta_0)^(1/m)"
  extends Oil.Compression.Law;
  input SI.BulkModulus beta_0(min = 1e6) = 1.5e9 "Tangent bulk modulus at p_0";
  input Real m(unit = "1", min = 0.1) = 10 "Growth of the bulk modulus with pressure";
  input SI.Pressure p_v = 0 "Pressure that is not reached however far the oil is drawn apart";
  input SI.Pressure w_v(min = 1) = 1e3 "Fall of the pressure over which voids grow to e times their volume";
protected
  Real x "Modulus over its value at p_0";
  Real v_l "Volume of the oil over that at p_0";
  Real v_v "Volume of voids over the volume of the oil at p_0";
  Real fall "How fast it falls with the pressure, times w_v";
algorithm
  x := max(1 + m*(p - p_0)/beta_0, 1e-3);
  v_l := x^(-1/m);
  (v_v, fall) := voids(p, p_v, w_v);
  rho := rho_0/(v_l + v_v);
  beta := (v_l + v_v)/(v_l/(beta_0*x) + fall/w_v);
  w := beta_0/rho_0*(if abs(m - 1) > 1e-6 then (x^(1 - 1/m) - 1)/(m - 1) else log(x)) - w_v*v_v/rho_0;
  annotation(Inline = true, Documentation(info = "<html><p>Murnaghan's equation of state; m is about 10 for mineral oils. Valid to some 100 MPa. Oil that is drawn apart opens voids, of the volume <code>exp(10 - (p - p_v)/w_v)</code> over that of the oil as in <code>entrainedAir</code>, less its tangent 25 <code>w_v</code> above <code>p_v</code>: from there on, 25 kPa, there are none, and the law is the one above; as much as the oil at 10 kPa, twenty thousand times as much at <code>p_v</code>. The modulus is the exact derivative.
Source: F. D. Murnaghan, Proc. Natl. Acad. Sci. 30 (1944) 244.</p></html>"));
end linearModulus;
