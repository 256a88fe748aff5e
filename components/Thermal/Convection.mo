within Thermal;
model Convection "Heat transfer whose conductance follows a signal"
  Interfaces.HeatPort solid "Solid side";
  Interfaces.HeatPort fluid "Fluid side";
  Interfaces.RealInput Gc(unit = "W/K") "Conductance";
equation
  solid.Q_flow = Gc*(solid.T - fluid.T);
  fluid.Q_flow = -solid.Q_flow;
end Convection;
