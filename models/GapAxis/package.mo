within;
package GapAxis "Servo-pump cylinder axis, the nominal plant for the comparison of model and bench"
  import Modelica.Units.SI;
end GapAxis;
