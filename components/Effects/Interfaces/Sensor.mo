within Effects.Interfaces;
partial model Sensor "Between a variable and what its sensor says"
  input Real u "True value";
  output Real y "Value recorded";
  annotation(__bramah(attach = "Sensor"));
end Sensor;
