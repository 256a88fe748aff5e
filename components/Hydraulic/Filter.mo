within Hydraulic;
model Filter "Filter: laminar resistance from a nominal point, with clogging"
  extends Bases.TwoPort;
  parameter SI.Pressure dp_nom(min = 1, nominal = 1e4) = 5e4 "Pressure drop at q_nom, clean";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, nominal = 1e-3) = 1e-3 "Flow of dp_nom";
  parameter SI.DynamicViscosity mu_nom(min = 1e-4, max = 10, nominal = 0.03) = 0.04 "Viscosity of the nominal point";
  parameter Real clogging(unit = "1", min = 0, max = 0.99) = 0 "Share of the element that is blocked";
equation
  assert(clogging < 1, "A filter blocked entirely lets nothing pass: clogging must be below 1");
  assert(dp_nom > 0 and q_nom > 0, "The nominal point must be positive");
  q = q_nom/dp_nom*mu_nom/mu_in*(1 - clogging)*dp;
  annotation(Documentation(info = "<html><p>Laminar, <code>q = q_nom dp/dp_nom</code> at the nominal viscosity, less the share that is blocked. Valid for clean oil of any viscosity up to the opening of a bypass, which has to be added (<code>CheckValve</code>). Source: Darcy's law; pressure drop over flow as ISO 3968 measures it.</p></html>"));
end Filter;
