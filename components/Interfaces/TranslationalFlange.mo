within Interfaces;
connector TranslationalFlange "Flange of a rod or slider"
  SI.Position s(nominal = 1e-2) "Absolute position of the flange";
  flow SI.Force f(nominal = 100) "Force acting on the component through the flange";
end TranslationalFlange;
