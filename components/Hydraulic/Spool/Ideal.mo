within Hydraulic.Spool;
block Ideal "Position equals command"
  extends Law;
equation
  y = min(max(u, -1), 1);
end Ideal;
