within Effects.Interfaces;
partial model TranslationalSeries "Elastic element where a connection is cut"
  input SI.Force f(stateSelect = StateSelect.avoid, nominal = 100) "Force through it";
  output SI.Distance s_rel(nominal = 1e-3) "Position of the first side relative to the second";
  annotation(__bramah(attach = "Series", drop = "s_rel", through = "f"));
end TranslationalSeries;
