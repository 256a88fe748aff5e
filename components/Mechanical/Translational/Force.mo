within Mechanical.Translational;
model Force "Force given by a signal, acting on a flange"
  Interfaces.TranslationalFlange flange "Flange";
  Interfaces.RealInput f(unit = "N") "Force that accelerates the component joined";
equation
  flange.f = -f;
  annotation(Documentation(info = "<html><p>Positive values accelerate what is joined in the positive direction; the reaction goes to the housing.</p></html>"));
end Force;
