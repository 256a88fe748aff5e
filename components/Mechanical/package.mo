within;
package Mechanical "Mechanics of rotation and translation in one dimension"
  import Modelica.Units.SI;
end Mechanical;
