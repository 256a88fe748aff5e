within;
package Oil "Oil of a circuit: density, bulk modulus and viscosity as replaceable laws, and ready oils"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html>
<p>A circuit declares one <code>inner Oil.Fluid oil</code> (or one of the ready oils); every hydraulic component finds it by
<code>outer Oil.Fluid oil</code>. Without it the default of <code>Oil.Fluid</code> is used.</p></html>"));
end Oil;
