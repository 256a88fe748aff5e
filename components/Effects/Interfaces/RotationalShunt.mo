within Effects.Interfaces;
partial model RotationalShunt "Torque on one node from the housing"
  input SI.Angle phi(stateSelect = StateSelect.avoid) "Angle of the node";
  output SI.Torque tau "Torque drawn from the node, against its motion";
  SI.AngularVelocity w(nominal = 10) "Speed of the node";
equation
  w = der(phi);
  annotation(__bramah(attach = "Shunt", potential = {"phi"}, through = "tau"));
end RotationalShunt;
