within Hydraulic.Spool;
block Ideal "Position equals command"
  extends Law;
equation
  y = min(max(u, -1), 1);
  annotation(Documentation(info = "<html><p><code>y = u</code>, limited to -1 to 1. For circuits slower than the valve.</p></html>"));
end Ideal;
