within Oil.Compression;
function constantModulus "Constant bulk modulus: rho = rho_0 exp((p - p_0)/beta_0)"
  extends Oil.Compression.Law;
  input SI.BulkModulus beta_0(min = 1e6) = 1.4e9 "Bulk modulus";
  input SI.Pressure p_v = 0 "Pressure that is not reached however far the oil is drawn apart";
  input SI.Pressure w_v(min = 1) = 1e3 "Fall of the pressure over which voids grow to e times their volume";
protected
  Real v_l "Volume of the oil over that at p_0";
  Real v_v "Volume of voids over the volume of the oil at p_0";
  Real fall "How fast it falls with the pressure, times w_v";
algorithm
  v_l := exp(-(p - p_0)/beta_0);
  (v_v, fall) := voids(p, p_v, w_v);
  rho := rho_0/(v_l + v_v);
  beta := (v_l + v_v)/(v_l/beta_0 + fall/w_v);
  w := beta_0/rho_0*(1 - v_l) - w_v*v_v/rho_0;
  annotation(Inline = true, Documentation(info = "<html><p>Integral of d rho/rho = dp/beta. Oil that is drawn apart opens voids, of the volume <code>exp(10 - (p - p_v)/w_v)</code> over that of the oil as in <code>entrainedAir</code>, less its tangent 25 <code>w_v</code> above <code>p_v</code>: from there on, 25 kPa, there are none, and the law is the one above; as much as the oil at 10 kPa, twenty thousand times as much at <code>p_v</code>. The modulus is the exact derivative.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 2.4. Valid where the modulus changes little: some 10 MPa about a level.</p></html>"));
end constantModulus;
