model Rig "Mass on a spring with a damper, pushed by a force"
  parameter Real m(unit = "kg", min = 0.1) = 2 "Mass";
  parameter Real d(unit = "N.s/m", min = 0) = 4 "Damping";
  parameter Real c(unit = "N/m", min = 1) = 50 "Stiffness";
  input Real F(unit = "N", start = 10) "Force";
  output Real x(unit = "m", start = 0, fixed = true) "Position";
  Real v(unit = "m/s", start = 0, fixed = true) "Velocity";
equation
  der(x) = v;
  m*der(v) = F - d*v - c*x;
  annotation(experiment(StopTime = 5, Interval = 0.05));
end Rig;
