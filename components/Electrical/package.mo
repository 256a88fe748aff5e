within;
package Electrical "Circuits, converters, machines and drives"
  import Modelica.Units.SI;
end Electrical;
