within;
package Modelica "The parts of the Modelica Standard Library's interface that bramah brings along: units, constants, mathematics"
  annotation(
    version = "4.0.0",
    Documentation(info = "<html>
<p>Usual names, own wording, so that models written here open unchanged where the Modelica Standard Library is installed. Only
<code>Modelica.Units</code>, <code>Modelica.Constants</code> and <code>Modelica.Math</code> are present; everything else of the
standard library is absent on purpose.</p></html>"));
end Modelica;
