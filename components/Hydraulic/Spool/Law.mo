within Hydraulic.Spool;
partial block Law "Spool position over command"
  Interfaces.RealInput u "Command, -1 to 1";
  Interfaces.RealOutput y "Position, -1 to 1";
  annotation(Documentation(info = "<html><p>The command and the position are parts of the full travel.</p></html>"));
end Law;
