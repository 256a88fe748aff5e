within Mechanical.Rotational;
model Position "Moves a flange exactly along a signal"
  Interfaces.RotationalFlange flange "Flange";
  Interfaces.RealInput phi_ref(unit = "rad") "Angle";
equation
  flange.phi = phi_ref;
end Position;
