within;
package Emps "Electro-mechanical positioning system, a benchmark of system identification"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html><p>A carriage on a ball screw, driven by a DC motor through a position loop. Source: A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS, 2019 Workshop on Nonlinear System Identification Benchmarks
(nonlinearbenchmark.org).</p></html>"));
end Emps;
