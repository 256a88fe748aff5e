within Signal;
block SecondOrder "Lag of second order: k/((s/w)^2 + 2 D s/w + 1)"
  extends Bases.OneToOne;
  parameter Real k = 1 "Gain";
  parameter SI.AngularFrequency w(min = 1e-9) = 1 "Natural frequency";
  parameter Real D(unit = "1", min = 0) = 1 "Damping";
  parameter Real y_start = 0 "Output at the start";
  Real yd(start = 0, fixed = true) "Rate of the output";
initial equation
  y = y_start;
equation
  assert(w > 0, "The natural frequency w must be positive");
  der(y) = yd;
  der(yd) = w*(w*(k*u - y) - 2*D*yd);
  annotation(Documentation(info = "<html><p><code>y'' + 2 D w y' + w^2 y = k w^2 u</code>.</p></html>"));
end SecondOrder;
