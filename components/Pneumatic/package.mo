within;
package Pneumatic "Pneumatic components: volumes, restrictions by ISO 6358, valves, cylinders, sources, sensors"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html>
<p>Ideal gas with its temperature: mass and energy are conserved by every component. Pressures are absolute; flows are mass flows, <code>q</code> is the
volume flow at the reference atmosphere (ANR). The gas is found by <code>outer Gas gas</code>. A port carries the enthalpy of what flows as a stream:
gas arrives with the temperature of where it comes from. Kinetic energy and waves are left out. A node of lines without any volume is an algebraic loop: it works, but a <code>Volume</code> there is closer to the
machine and faster.</p></html>"));
end Pneumatic;
