within Hydraulic.Spool;
partial block Law "Spool position over command"
  Interfaces.RealInput u "Command, -1 to 1";
  Interfaces.RealOutput y "Position, -1 to 1";
end Law;
