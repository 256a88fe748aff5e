within Oil;
model Fluid "Oil of the circuit: laws of density with bulk modulus and of viscosity"
  parameter SI.Density rho_0(min = 500, max = 2000) = 860 "Density of the air-free oil at p_0 and the temperature of the circuit";
  parameter SI.Pressure p_0(min = 1e4, max = 1e6) = 101325 "Reference pressure of rho_0 and alpha_0, also of the surroundings";
  parameter SI.Temperature T_0(min = 220, max = 420) = 313.15 "Temperature of the oil where it is constant, of rho_0, and of oil whose temperature nobody gives";
  parameter SI.BulkModulus beta_0(min = 1e7, max = 1e10, nominal = 1e9) = 1.5e9 "Tangent bulk modulus of the air-free oil at p_0";
  parameter Real m(unit = "1", min = 0.1, max = 30) = 10 "Growth of the bulk modulus with pressure";
  parameter SI.VolumeFraction alpha_0(min = 0, max = 0.2) = 0.01 "Share of free air in the volume at p_0, before any of it dissolves";
  parameter Real x_u(unit = "1", min = 0, max = 1) = 0.2 "Share of the air that is not dissolved in lines and volumes";
  parameter Real n_g(unit = "1", min = 1, max = 1.67) = 1.2 "Polytropic exponent of the air bubbles";
  parameter SI.DynamicViscosity mu_ref(min = 1e-4, max = 10, nominal = 0.03) = 0.0396 "Dynamic viscosity at T_mu and low pressure";
  parameter SI.Temperature T_mu(min = 220, max = 420) = 313.15 "Temperature of mu_ref";
  parameter SI.LinearTemperatureCoefficient lambda(min = 0, max = 0.2) = 0.035 "Viscosity falls by exp(-lambda) per kelvin";
  parameter Boolean thermal = false "true: the oil has a temperature of its own at every place and carries heat; false: that of the circuit" annotation(Evaluate = true);
  parameter SI.SpecificHeatCapacity c_p(min = 500, max = 10000) = 1900 "Heat capacity, for thermal";
  parameter SI.CubicExpansionCoefficient gamma(min = 0, max = 5e-3) = 7e-4 "Growth of the volume per kelvin over that at T_0, for thermal";
  parameter SI.Pressure p_max(min = 1e6, max = 1e10, nominal = 1e8) = 1e8 "Pressure above which a warning is given: no machine stands it";
  parameter SI.Pressure p_void(min = 0, nominal = 1e4) = 1.4e4 "Pressure below which a warning is given: voids open in the oil";
  final parameter SI.Pressure p_l = max(p_void, 1.4e4) + 1.1e4 "Lowest pressure without voids";
  final parameter SI.Density rho_l = density(p_l) "Density there: what the oil between the voids has";
  parameter Boolean useTemperatureInput = false "true: the temperature comes through T_in" annotation(Evaluate = true);
  replaceable function density = Oil.Compression.entrainedAir(beta_0 = beta_0, m = m, alpha_0 = alpha_0, n_g = n_g)
    constrainedby Oil.Compression.Law(rho_0 = rho_0, p_0 = p_0, x_u = x_u) "Density and tangent bulk modulus at a pressure";
  replaceable function viscosity = Oil.Viscosity.exponential(mu_ref = mu_ref, T_mu = T_mu, lambda = lambda)
    constrainedby Oil.Viscosity.Law "Dynamic viscosity at low pressure over temperature";
  replaceable function thickening = Oil.Thickening.none
    constrainedby Oil.Thickening.Law "Dynamic viscosity at a pressure from that at low pressure";
  function throttling = Oil.Heat.throttling(redeclare function law = density, c_p = c_p, gamma = gamma, T_0 = T_0) "Gain of temperature from a pressure down to p_0";
  function voidWork = Oil.Heat.voidWork(redeclare function law = density, p_l = p_l, rho_l = rho_l) "What voids add to the integral of dp/rho below p_l";
  function growth = Oil.Heat.growth(gamma = gamma, T_0 = T_0) "Volume at a temperature over that at T_0";
  Interfaces.RealInput T_in(unit = "K") if useTemperatureInput "Temperature of the oil";
  SI.Temperature T "Temperature of the oil in the circuit";
  SI.DynamicViscosity mu(nominal = 0.03) "Dynamic viscosity at that temperature and low pressure";
protected
  Interfaces.RealInput T_used(unit = "K");
equation
  assert(rho_0 > 0, "The density of the oil must be positive");
  assert(beta_0 > 0, "The bulk modulus of the oil must be positive");
  assert(alpha_0 >= 0 and alpha_0 < 1, "The share of air in the oil must lie from 0 to below 1");
  assert(not (thermal and useTemperatureInput), "Oil that carries heat has no temperature of the circuit: set thermal or useTemperatureInput, not both");
  connect(T_in, T_used);
  if not useTemperatureInput then
    T_used = T_0;
  end if;
  T = T_used;
  mu = viscosity(T);
  annotation(
    defaultComponentName = "oil",
    defaultComponentPrefixes = "inner",
    missingInnerMessage = "No oil is declared: a mineral oil of VG 46 at 40 degC with 1 % air, a fifth of it undissolved, is used. Declare `inner Oil.Fluid oil` (or one of the ready oils) to choose another.",
    Documentation(info = "<html>
<p>Declared once in a circuit as <code>inner Oil.Fluid oil</code>. Three laws can be exchanged by <code>redeclare function</code>:</p>
<ul>
<li><code>density(p)</code> returns the density and, as second result, the tangent bulk modulus <code>beta = rho/(d rho/d p)</code>. Both come from
one law, so that they cannot contradict each other and volumes conserve mass. Choices: <code>Oil.Compression.constantModulus</code>,
<code>linearModulus</code>, <code>entrainedAir</code> (default), <code>dissolvingAir</code>.</li>
<li><code>viscosity(T)</code>, at low pressure: <code>Oil.Viscosity.constantViscosity</code>, <code>exponential</code> (default),
<code>astmD341</code>.</li>
<li><code>thickening(mu, p)</code>, viscosity under pressure: <code>Oil.Thickening.none</code> (default), <code>barus</code>,
<code>roelands</code>.</li>
</ul>
<p>The parameters <code>beta_0</code> to <code>lambda</code> feed the default laws; a law put in their place takes its values with the
redeclaration, for instance <code>redeclare function density = Oil.Compression.linearModulus(beta_0 = 1.6e9, m = 12)</code>.</p>
<p><b>Heat.</b> With <code>thermal = true</code> every volume, chamber, line, reservoir and machine has a temperature of its own, flow carries heat, and density and viscosity follow: see <code>Oil.Heat</code> and <code>Hydraulic.Bases.Storage</code>. The volume grows with <code>gamma</code>
per kelvin, and <code>c_p</code> is constant: set <code>T_0</code> to the middle of the range of temperatures. Otherwise the oil has one temperature, <code>T_0</code> or what comes through <code>T_in</code>.</p>
<p><b>Low pressure.</b> Every law opens voids, so that the density falls to nothing as the pressure falls to <code>p_v</code> of the law, 0: see <code>Oil.Compression.entrainedAir</code>. Give a law another <code>p_v</code> and <code>p_void</code> rises by as much.</p>
<p>Valid from about 0.01 to 50 MPa and -20 to 120 degC. The default is a mineral oil of ISO VG 46 at 40 degC.</p></html>"));
end Fluid;
