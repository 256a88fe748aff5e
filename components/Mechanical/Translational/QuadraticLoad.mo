within Mechanical.Translational;
model QuadraticLoad "Load that grows with the square of speed, against the motion"
  Interfaces.TranslationalFlange flange "Flange";
  parameter SI.Force f_nominal(min = 0) = 1 "Magnitude at v_nominal";
  parameter SI.Velocity v_nominal(min = 1e-9) = 0.1 "Speed of f_nominal";
  SI.Velocity v(nominal = 0.1) "Speed";
equation
  assert(v_nominal > 0, "v_nominal must be positive");
  v = der(flange.s);
  flange.f = f_nominal*(v/v_nominal)*noEvent(abs(v/v_nominal));
  annotation(Documentation(info = "<html><p>A fan or a ship: the force grows with the square of the velocity and acts against it.</p></html>"));
end QuadraticLoad;
