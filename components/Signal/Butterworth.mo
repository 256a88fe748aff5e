within Signal;
block Butterworth "Butterworth low pass of even order: flat up to its corner"
  extends Bases.OneToOne;
  parameter SI.Frequency f_c(min = 1e-6, nominal = 100) = 100 "Corner frequency, -3 dB";
  parameter Integer sections(min = 1, max = 10) = 1 "Sections of second order; the order is twice as many";
  parameter Real y_start = 0 "Output at the start";
  Real x[sections](each start = y_start, each fixed = true) "Outputs of the sections";
  Real v[sections](each unit = "1/s", each start = 0, each fixed = true) "Their derivatives";
protected
  parameter SI.AngularFrequency w = 2*Modelica.Constants.pi*f_c "Corner";
  parameter Real D[sections] = {sin((2*i - 1)*Modelica.Constants.pi/(4*sections)) for i in 1:sections} "Damping ratios of the sections";
equation
  assert(f_c > 0, "The corner frequency must be positive");
  for i in 1:sections loop
    der(x[i]) = v[i];
    der(v[i]) = w^2*((if i == 1 then u else x[max(i - 1, 1)]) - x[i]) - 2*D[i]*w*v[i];
  end for;
  y = x[sections];
  annotation(Documentation(info = "<html><p>Sections <code>1/(s^2/w^2 + 2 D_i s/w + 1)</code> with <code>D_i = sin((2 i - 1) pi/(4 n))</code>: the filter before an analogue input. Source: U. Tietze, C. Schenk and E. Gamm, Electronic Circuits, chapter 13.</p></html>"));
end Butterworth;
