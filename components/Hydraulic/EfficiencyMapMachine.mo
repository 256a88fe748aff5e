within Hydraulic;
model EfficiencyMapMachine "Displacement machine from measured volumetric and hydromechanical efficiency maps"
  extends Bases.Machine(compression = false);
  parameter Real eta_v[:, :] = [0, 1e6, 1e7, 3e7; 10, 0.90, 0.60, 0.30; 100, 0.98, 0.94, 0.85; 300, 0.99, 0.98, 0.95] "Volumetric efficiency pumping: first column speeds in rad/s from row 2 on, first row pressure differences in Pa from column 2 on";
  parameter Real eta_m[:, :] = [0, 1e6, 1e7, 3e7; 10, 0.60, 0.90, 0.92; 100, 0.65, 0.91, 0.94; 300, 0.60, 0.90, 0.93] "Hydromechanical efficiency pumping, likewise";
  parameter String fileName = "" "File that holds both maps (CSV, or Modelica's text format); empty: they are written here";
  parameter String name_v = "eta_v" "Name of the volumetric map in the file";
  parameter String name_m = "eta_m" "Name of the hydromechanical map in the file";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed";
protected
  final parameter Integer n_v[2] = if fileName == "" then {size(eta_v, 1), size(eta_v, 2)} else Signal.Functions.tableSize(fileName, name_v) "Rows, columns";
  final parameter Integer n_m[2] = if fileName == "" then {size(eta_m, 1), size(eta_m, 2)} else Signal.Functions.tableSize(fileName, name_m) "Rows, columns";
  final parameter Real map_v[n_v[1], n_v[2]] = if fileName == "" then eta_v else Signal.Functions.readTable(fileName, name_v, 2, n_v[1], n_v[2]) "The volumetric map in use";
  final parameter Real map_m[n_m[1], n_m[2]] = if fileName == "" then eta_m else Signal.Functions.readTable(fileName, name_m, 2, n_m[1], n_m[2]) "The hydromechanical map in use";
  final parameter SI.AngularVelocity w_1 = max(map_v[2, 1], map_m[2, 1]) "Least speed of both maps";
  final parameter SI.AngularVelocity w_2 = min(map_v[end, 1], map_m[end, 1]) "Greatest speed of both maps";
  final parameter SI.Pressure p_1 = max(map_v[1, 2], map_m[1, 2]) "Least pressure difference of both maps";
  final parameter SI.Pressure p_2 = min(map_v[1, end], map_m[1, end]) "Greatest pressure difference of both maps";
  SI.AngularVelocity w_map "Magnitude of speed within the maps";
  SI.Pressure p_map "Magnitude of pressure difference within the maps";
  Real loss_v(unit = "1") "Share of the delivery lost";
  Real loss_m(unit = "1") "Share of the torque added";
equation
  assert(n_v[1] > 2 and n_v[2] > 2 and n_m[1] > 2 and n_m[2] > 2, "The maps need at least two speeds and two pressures each");
  for i in 3:n_v[1] loop
    assert(map_v[i, 1] > map_v[i - 1, 1], "The speeds of the volumetric map must increase");
  end for;
  for j in 3:n_v[2] loop
    assert(map_v[1, j] > map_v[1, j - 1], "The pressures of the volumetric map must increase");
  end for;
  for i in 3:n_m[1] loop
    assert(map_m[i, 1] > map_m[i - 1, 1], "The speeds of the hydromechanical map must increase");
  end for;
  for j in 3:n_m[2] loop
    assert(map_m[1, j] > map_m[1, j - 1], "The pressures of the hydromechanical map must increase");
  end for;
  assert(w_2 > w_1 and p_2 > p_1, "The two maps must overlap in speed and pressure");
  assert(w_1 > 0 and p_1 > 0, "Speeds and pressures of the maps must be positive");
  assert(min(map_v[2:end, 2:end]) >= 0 and max(map_v[2:end, 2:end]) <= 1, "Volumetric efficiencies must lie from 0 to 1");
  assert(min(map_m[2:end, 2:end]) > 0 and max(map_m[2:end, 2:end]) <= 1, "Hydromechanical efficiencies must lie above 0, up to 1");
  w_map = min(max(sqrt(w*w + 1e-4), w_1), w_2);
  p_map = min(max(sqrt(dp*dp + 1e6), p_1), p_2);
  loss_v = 1 - Signal.Functions.interpolate2(map_v[2:end, 1], map_v[1, 2:end], map_v[2:end, 2:end], w_map, p_map);
  loss_m = 1/Signal.Functions.interpolate2(map_m[2:end, 1], map_m[1, 2:end], map_m[2:end, 2:end], w_map, p_map) - 1;
  Q_leak = loss_v*V*w_map/(2*pi)*dp/p_map;
  T_loss = loss_m*D*p_map*Smooth.sgn(w, w_s)*min(abs(dp)/p_map + 1e-2, 1);
  annotation(Documentation(info = "<html><p>The maps hold what was measured pumping: <code>eta_v</code>, delivery over <code>V n</code>, and <code>eta_m</code>, ideal torque over the shaft's, rows by speed, columns by pressure difference, bilinear between. They are written in the model, or read from a file that holds both (<code>fileName</code>; for its form see <code>Signal.Functions.readTable</code>).</p>
<p>The losses, leakage <code>(1 - eta_v) V n</code> and torque <code>(1/eta_m - 1) D dp</code>, are applied in all four quadrants, so that motoring and standstill stay passive. Outside the maps the losses of the edge hold, the leakage falling with the pressure. Valid at the temperature at which the maps were measured: viscosity does not change them. Source: efficiencies as defined by ISO 4409.</p></html>"));
end EfficiencyMapMachine;
