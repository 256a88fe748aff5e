within Effects.Interfaces;
partial model Command "Between an input of the model and what acts on it"
  input Real u "Value commanded";
  output Real y "Value that acts";
  annotation(__bramah(attach = "Command"));
end Command;
