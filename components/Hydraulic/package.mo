within;
package Hydraulic "Hydraulic components: volumes, restrictions, valves, machines, cylinders, accumulators, sources, sensors"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html>
<p>Pressures are absolute; a volume flow is counted at the pressure of its port; mass is conserved by every component. The oil is found by
<code>outer Oil.Fluid oil</code>. A node of lines without any volume is an algebraic loop: it works, but a <code>Volume</code> there is closer to the
machine and faster.</p></html>"));
end Hydraulic;
