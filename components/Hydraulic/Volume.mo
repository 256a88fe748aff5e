within Hydraulic;
model Volume "Oil in a rigid or compliant volume"
  extends Bases.Storage(stored(nominal = oil.rho_0*V));
  parameter SI.Volume V(min = 1e-9, max = 10, nominal = 1e-3, displayUnit = "ml") = 1e-3 "Volume at the reference pressure of the oil";
  parameter SI.BulkModulus beta_wall(min = 1e6, nominal = 1e9) = Modelica.Constants.inf "Modulus of the wall: 0.5 to 1 GPa for hoses, infinite for tubes";
  parameter SI.Pressure p_start(nominal = 1e6) = 101325 "Pressure at the start";
  SI.Pressure p(start = p_start, nominal = 1e6, stateSelect = StateSelect.prefer) "Pressure";
equation
  assert(V > 0, "The volume V must be positive");
  assert(beta_wall > 0, "The modulus of the wall must be positive");
  assert(p > oil.p_void, "The oil cavitates: more is drawn than flows in, and voids open in the oil. Is a check valve or a charge pump missing?", AssertionLevel.warning);
  assert(p < oil.p_max, "The pressure exceeds p_max of the oil: more flows in than can leave. Is a relief valve missing, set too high, or joined the wrong way round?", AssertionLevel.warning);
  p = port.p;
  V_oil = V*(1 + (p - oil.p_0)/beta_wall);
  (V_oil/air.beta + V/beta_wall)*der(p) = inflow;
  annotation(Documentation(info = "<html>
<p>Balance of mass, <code>d(rho V_oil)/dt = rho q</code>, written for the pressure: <code>(V_oil/beta + V/beta_wall) dp/dt = q</code>. With the wall,
<code>V_oil = V (1 + (p - p_0)/beta_wall)</code>. Any number of lines may be joined to the port. Two volumes joined without a restriction become one by index
reduction; the start that the circuit gives one of them counts for both.</p>
<p>The air in the oil is frozen; <code>redeclare model Air = EntrainedAir.Dissolving</code> lets it dissolve and come out of solution with time.</p>
<p>Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 3.10.</p></html>"));
end Volume;
