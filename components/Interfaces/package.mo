within;
package Interfaces "Ports through which components are joined, and signal connectors"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html>
<p>A physical port carries a potential (equal at all joined ports) and a flow (sum zero, positive into the component). The domain of a
port is recognised by these two quantities: hydraulic <code>Pa, m3/s</code>; rotation <code>rad, N.m</code>; translation
<code>m, N</code>; electrical <code>V, A</code>; thermal <code>K, W</code>.</p></html>"));
end Interfaces;
