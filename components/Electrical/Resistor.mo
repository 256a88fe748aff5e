within Electrical;
model Resistor "Resistor, temperature dependent where a heat port is used"
  extends Bases.OnePort;
  parameter SI.Resistance R(min = 1e-6, max = 1e12, nominal = 1) = 1 "Resistance at T_ref";
  parameter SI.LinearTemperatureCoefficient alpha(min = -0.02, max = 0.02) = 0 "Temperature coefficient; copper 0.0039";
  parameter SI.Temperature T_ref(min = 1) = 293.15 "Temperature of R";
  parameter Boolean useHeatPort = false "true: heats what is joined to heatPort and follows its temperature" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(T = T, Q_flow = -lossPower) if useHeatPort "Heat";
  SI.Temperature T "Temperature";
  SI.Power lossPower "Power lost";
equation
  assert(R > 0, "The resistance R must be positive");
  if not useHeatPort then
    T = T_ref;
  end if;
  v = R*(1 + alpha*(T - T_ref))*i;
  lossPower = v*i;
  annotation(Documentation(info = "<html><p><code>v = R i</code>, with a temperature coefficient where the heat port is used.</p></html>"));
end Resistor;
