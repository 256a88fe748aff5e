within;
package ServoPump "Electro-hydraulic servo pump of Zhang et al., Processes 2021, 9, 814"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html><p>Axial piston pump of 0.8 ml/r driven by a permanent magnet synchronous motor. Figure and equation numbers are those of the paper.</p></html>"));
end ServoPump;
