within;
package Signal "Blocks: sources, mathematics, controllers, filters, limits, tables, logic"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html><p>Input <code>u</code>, output <code>y</code> as in the Modelica Standard Library. Blocks that switch do it by events; curves with corners that are no events (limits) stay continuous.</p></html>"));
end Signal;
