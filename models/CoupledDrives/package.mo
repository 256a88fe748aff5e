within;
package CoupledDrives "Two motors and a pulley on one elastic belt: a benchmark of system identification"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html><p>Two motors drive a belt over a pulley that hangs on a spring. Measured are the common voltage of the motors and the speed of the pulley, every 20 ms, by a pick-up that sees the magnitude of the speed alone.</p>
<p>The recording knows volts only: the inertia of the motors and the gain of the pick-up are chosen, the rest follows from a fit. Source of the data: T. Wigren, M. Schoukens, Coupled electric drives data set and reference models, Uppsala University 2017
(nonlinearbenchmark.org).</p></html>"));
end CoupledDrives;
