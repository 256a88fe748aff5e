within Hydraulic;
model EfficiencyMapMachine "Displacement machine from measured volumetric and hydromechanical efficiency maps"
  extends Bases.Machine(compression = false, starvation = false);
  parameter Real speeds[:](each unit = "rad/s") = {10, 100, 300} "Speeds of the maps, increasing";
  parameter Real pressures[:](each unit = "Pa") = {1e6, 1e7, 3e7} "Pressure differences of the maps, increasing";
  parameter Real eta_v[:, :] = [0.90, 0.60, 0.30; 0.98, 0.94, 0.85; 0.99, 0.98, 0.95] "Volumetric efficiency pumping, rows by speed";
  parameter Real eta_m[:, :] = [0.60, 0.90, 0.92; 0.65, 0.91, 0.94; 0.60, 0.90, 0.93] "Hydromechanical efficiency pumping, rows by speed";
  parameter SI.AngularVelocity w_s(min = 1e-3) = 1 "Width of the sign of speed";
protected
  SI.AngularVelocity w_map "Magnitude of speed within the map";
  SI.Pressure p_map "Magnitude of pressure difference within the map";
  Real loss_v(unit = "1") "Share of the delivery lost";
  Real loss_m(unit = "1") "Share of the torque added";
equation
  assert(size(eta_v, 1) == size(speeds, 1) and size(eta_v, 2) == size(pressures, 1), "eta_v must have a row per speed and a column per pressure");
  assert(size(eta_m, 1) == size(speeds, 1) and size(eta_m, 2) == size(pressures, 1), "eta_m must have a row per speed and a column per pressure");
  for i in 2:size(speeds, 1) loop
    assert(speeds[i] > speeds[i - 1], "The speeds of the maps must increase");
  end for;
  for i in 2:size(pressures, 1) loop
    assert(pressures[i] > pressures[i - 1], "The pressures of the maps must increase");
  end for;
  w_map = min(max(sqrt(w*w + 1e-4), speeds[1]), speeds[size(speeds, 1)]);
  p_map = min(max(sqrt(dp*dp + 1e6), pressures[1]), pressures[size(pressures, 1)]);
  loss_v = max(1 - Signal.Functions.interpolate2(speeds, pressures, eta_v, w_map, p_map), 0);
  loss_m = max(1/Signal.Functions.interpolate2(speeds, pressures, eta_m, w_map, p_map) - 1, 0);
  Q_leak = loss_v*V*w_map/(2*pi)*dp/p_map;
  T_loss = loss_m*D*p_map*Smooth.sgn(w, w_s)*min(abs(dp)/p_map + 1e-2, 1);
  annotation(Documentation(info = "<html><p>The losses of the map, leakage <code>(1 - eta_v) V n</code> and torque <code>(1/eta_m - 1) D dp</code>, are applied in all four quadrants, so that motoring and standstill stay passive; outside the map the losses of its edge hold, the leakage falling with the pressure.</p></html>"));
end EfficiencyMapMachine;
