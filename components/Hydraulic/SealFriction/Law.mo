within Hydraulic.SealFriction;
partial model Law "Friction of a piston against its cylinder"
  Interfaces.TranslationalFlange flange "Piston";
  input SI.Pressure p_1 "Pressure of chamber 1, above the surroundings";
  input SI.Pressure p_2 "Pressure of chamber 2, above the surroundings";
  SI.Force f(nominal = 100) "Friction force, positive against positive motion";
equation
  flange.f = f;
  annotation(Documentation(info = "<html><p>Pressures count above the surroundings. All forms have the same ports: exchange them by redeclaration.</p></html>"));
end Law;
