within Mechanical.Translational;
model Force "Force given by a signal, acting on a flange"
  Interfaces.TranslationalFlange flange "Flange";
  Interfaces.RealInput f(unit = "N") "Force that accelerates the component joined";
equation
  flange.f = -f;
end Force;
