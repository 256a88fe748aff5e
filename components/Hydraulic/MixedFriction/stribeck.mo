within Hydraulic.MixedFriction;
function stribeck "The film carries with speed: dry friction as it stops, the given share far above"
  extends Law;
  input Real Sc_0(unit = "1", min = 1e-12) = 1e-7 "Number mu w/p at which the film has formed to 63 %";
protected
  Real Sc "Number of Stribeck: viscosity times speed over pressure";
algorithm
  Sc := mu*Smooth.mag(w, 1e-2)/(Smooth.mag(dp, 1e4) + 1e5);
  w_f := w_0*(1 - exp(-Sc/Sc_0));
  annotation(Inline = true, Documentation(info = "<html>
<p><code>1 - w_f = (1 - w_0) + w_0 exp(-Sc/Sc_0)</code> with <code>Sc = mu |w|/(|dp| + 1e5 Pa)</code>: the mechanical efficiency falls at low speed and high pressure, as measured machines show. At 100 bar and 0.03 Pa s the default has the film at 35 rad/s.</p>
<p><code>Sc_0</code> is assumed and wants to be fitted. Source: form after R. Stribeck, Z. VDI 46 (1902) 1341; for pistons in bores: N. D. Manring, J. Dyn. Sys. Meas. Control 121 (1999) 531.</p></html>"));
end stribeck;
