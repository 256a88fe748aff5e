within Signal;
block PadeDelay "Delay of a continuous signal, Pade approximation of second order"
  extends Bases.OneToOne;
  parameter SI.Time T(min = 1e-9) = 0.01 "Delay";
  Real x_1(start = 0, fixed = true) "First state";
  Real x_2(start = 0, fixed = true) "Second state";
equation
  assert(T > 0, "The delay T must be positive");
  der(x_1) = x_2/T;
  der(x_2) = (12*(u - x_1) - 6*x_2)/T;
  y = u - x_2;
  annotation(Documentation(info = "<html><p><code>(12 - 6 T s + T^2 s^2)/(12 + 6 T s + T^2 s^2)</code>; good to about 2/T in angular frequency.</p></html>"));
end PadeDelay;
