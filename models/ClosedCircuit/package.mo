within;
package ClosedCircuit "Variable-speed closed circuit with induction motor (DOI 10.1177/09544054221102779)"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html><p>Induction motor, axial piston pump, hydraulic motor and load. The tables of the paper are not at hand; every number is assumed such that its qualitative statements hold.</p></html>"));
end ClosedCircuit;
