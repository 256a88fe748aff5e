within ServoPump;
model ResolvedSystem "The system of Fig. 1 with the pump piston by piston"
  extends System(
    redeclare PistonPump pump);
  annotation(
    experiment(StartTime = 0, StopTime = 3, Interval = 0.002, Tolerance = 1e-5),
    Documentation(info = "<html><p>Seven chambers whose ports open within three degrees: the pressure of a chamber follows its port within nanoseconds.</p></html>"));
end ResolvedSystem;
