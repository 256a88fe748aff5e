within Thermal;
model Convection "Heat transfer whose conductance follows a signal"
  Interfaces.HeatPort solid "Solid side";
  Interfaces.HeatPort fluid "Fluid side";
  Interfaces.RealInput Gc(unit = "W/K") "Conductance";
equation
  solid.Q_flow = Gc*(solid.T - fluid.T);
  fluid.Q_flow = -solid.Q_flow;
  annotation(Documentation(info = "<html><p><code>Q = G_c (T_solid - T_fluid)</code> with the conductance as a signal, for instance over the speed of a fan.</p></html>"));
end Convection;
