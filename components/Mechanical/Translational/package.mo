within Mechanical;
package Translational "Mechanics of motion along one axis"
  annotation(Documentation(info = "<html>
<p>Position and Force at the flanges as in the Modelica Standard Library: force is positive where it acts on the component; a component with
<code>flange_a</code> and <code>flange_b</code> takes positive force at a and gives it on at b when it is pushed in the positive direction.</p></html>"));
end Translational;
