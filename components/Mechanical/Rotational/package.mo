within Mechanical;
package Rotational "Mechanics of rotation about one axis"
  annotation(Documentation(info = "<html>
<p>Angle and Torque at the flanges as in the Modelica Standard Library: torque is positive where it acts on the component; a component with
<code>flange_a</code> and <code>flange_b</code> takes positive torque at a and gives it on at b when it is pushed in the positive direction.</p></html>"));
end Rotational;
