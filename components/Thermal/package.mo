within;
package Thermal "Lumped heat storage and transfer"
  import Modelica.Units.SI;
end Thermal;
