within Hydraulic;
model WaterCooler "Cooler with water in counterflow"
  extends Bases.HeatExchanger(kA = 1500);
  parameter SI.Temperature T_water(min = 273, max = 373) = 288.15 "Temperature at which the water comes";
  parameter SI.MassFlowRate m_water(min = 1e-6, nominal = 0.1) = 0.2 "Flow of the water";
  parameter SI.SpecificHeatCapacity c_water(min = 500, max = 10000) = 4186 "Heat capacity of the water";
  parameter Boolean useInput = false "true: u opens the valve of the water" annotation(Evaluate = true);
  Interfaces.RealInput u(unit = "1") if useInput "Flow of the water over m_water";
  SI.Temperature T_return(nominal = 300) "Temperature at which the water leaves";
protected
  Interfaces.RealInput u_used(unit = "1") "Flow of the water over m_water";
  SI.ThermalConductance C_water(nominal = 1e3) "Heat capacity of the water that flows";
  SI.ThermalConductance C_less(nominal = 1e3) "The smaller of the two";
  Real ratio(unit = "1") "It over the larger one, below 1";
  Real N(unit = "1") "Number of transfer units";
equation
  assert(oil.thermal, "A cooler with water needs oil that carries heat: declare it with thermal = true");
  assert(m_water > 0, "The flow of the water must be positive");
  connect(u, u_used);
  if not useInput then
    u_used = 1;
  end if;
  C_water = m_water*c_water*max(u_used, 1e-4);
  C_less = min(C_water, C_oil);
  ratio = min(C_less/max(C_water, C_oil), 0.9999);
  N = kA/C_less;
  T_coolant = T_water;
  effectiveness = C_less/C_oil*(1 - exp(-N*(1 - ratio)))/(1 - ratio*exp(-N*(1 - ratio)));
  if not oil.thermal then
    Q_flow = 0;
  end if;
  T_return = T_water + Q_flow/C_water;
  annotation(Documentation(info = "<html>
<p>Counterflow of two streams: with the smaller of the heat capacities that flow, <code>C_less</code>, its ratio r to the larger and <code>N = kA/C_less</code>, the smaller stream changes by
<code>(1 - exp(-N (1 - r)))/(1 - r exp(-N (1 - r)))</code> of the difference at the inlets. kA is constant; <code>u</code> is the opening of a water valve. Source: W. M. Kays and A. L. London, Compact Heat Exchangers, 1984, table 2-2.</p></html>"));
end WaterCooler;
