model WaterTubes "Eighteen tubes between thirteen nodes, two of which store water (index 2)"
  constant Real nu = 1.31e-6 "Kinematic viscosity";
  constant Real rho = 1e3 "Density";
  constant Real g = 9.8;
  constant Real R_crit = 2.3e3 "Reynolds number of the transition";
  constant Real L = 1e3 "Length of the tubes";
  constant Real k = 2e-4 "Roughness";
  constant Real d = 1 "Diameter";
  constant Real A = Modelica.Constants.pi*d^2/4 "Cross section";
  constant Real b = 200 "Surface of the tanks";
  constant Integer from[18] = {1, 2, 2, 3, 3, 4, 5, 6, 7, 7, 8, 8, 9, 11, 11, 12, 12, 13};
  constant Integer to[18] = {2, 3, 6, 4, 5, 5, 10, 5, 4, 8, 5, 10, 8, 9, 12, 7, 8, 11};
  Real phi[18](each start = 0, each nominal = 1e-3) "Flows";
  Real lambda[18](each start = 0.047519404529185289807, each nominal = 0.05, each min = 1e-3) "Friction";
  Real p[13](each start = 109800, fixed = {n == 5 or n == 8 for n in 1:13}, each nominal = 1e5) "Pressures";
  Real e_1, e_13, e_10 "Flows in and out";
protected
  Real R[18](each nominal = 1000) "Reynolds numbers";
  Real net[13](each nominal = 1e-3) "What the tubes bring to a node";
  Boolean turbulent[18](each start = false, each fixed = true);
  Real h "Time in hours";
initial equation
  phi[{3, 4, 9, 11, 12, 15, 16}] = zeros(7);
equation
  h = time/3600;
  e_1 = (1 - cos(exp(-h) - 1))/200;
  e_13 = (1 - cos(exp(-h) - 1))/80;
  e_10 = h^2*(3*h^2 - 92*h + 720)/1e6;
  for i in 1:18 loop
    R[i] = abs(phi[i]*d/(nu*A));
    turbulent[i] = R[i] > R_crit;
    rho*L/A*der(phi[i]) = p[from[i]] - p[to[i]]
      - (if turbulent[i] then lambda[i]*rho*L*phi[i]^2/(A^2*d) else 32*nu*rho*L*phi[i]/(A*d^2));
    1/sqrt(lambda[i]) - 1.74 + 2*log10(2*k/d + 18.7/((if turbulent[i] then R[i] else R_crit)*sqrt(lambda[i]))) = 0;
  end for;
  for n in 1:13 loop
    net[n] = sum(if to[i] == n then phi[i] elseif from[i] == n then -phi[i] else 0 for i in 1:18)
      + (if n == 1 then e_1 elseif n == 13 then e_13 elseif n == 10 then -e_10 else 0);
    if n == 5 or n == 8 then
      b/(rho*g)*der(p[n]) = net[n];
    else
      net[n] = 0;
    end if;
  end for;
  annotation(
    experiment(StartTime = 0, StopTime = 61200, Interval = 120, Tolerance = 1e-6),
    Documentation(info = "<html><p>In SI units. Source: B. Koren and others 1995; Test Set for IVP Solvers, problem WATER, with the published values at 17 h.</p></html>"));
end WaterTubes;
