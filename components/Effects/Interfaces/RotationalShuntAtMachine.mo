within Effects.Interfaces;
partial model RotationalShuntAtMachine "Torque on the shaft of a component with two hydraulic ports"
  input SI.Angle phi(stateSelect = StateSelect.avoid) "Angle of the node";
  input SI.Pressure p_a(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the first port";
  input SI.Pressure p_b(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the second port";
  output SI.Torque tau "Torque drawn from the node, against its motion";
  SI.AngularVelocity w(nominal = 10) "Speed of the node";
  SI.Pressure dp(nominal = 1e6) "Pressure difference";
equation
  w = der(phi);
  dp = p_a - p_b;
  annotation(__bramah(attach = "Shunt", potential = {"phi"}, through = "tau", sense = {"p_a", "p_b"}));
end RotationalShuntAtMachine;
