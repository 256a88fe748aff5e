within;
package CascadedTanks "Two open tanks, one above the other, fed by a pump: a benchmark of system identification"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html><p>A pump lifts water into the upper tank; it runs through a hole into the lower tank and from there into the reservoir. Measured are the pump voltage and the level of the lower tank, in volts, every 4 s. With large inputs the upper tank
overflows, and part of that water falls into the lower one.</p>
<p>The recording knows volts only, so one length and one area may be chosen: 1 V of the level sensor stands for 0.1 m, both tanks have 0.01 m2. Everything else follows from a fit to the estimation record. Source of the data: M. Schoukens, J.-P. Noel, Three benchmarks addressing open challenges in nonlinear system identification, IFAC World Congress 2017
(nonlinearbenchmark.org).</p></html>"));
end CascadedTanks;
