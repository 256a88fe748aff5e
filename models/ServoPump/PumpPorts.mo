within ServoPump;
partial model PumpPorts "What the bench expects of its pump, averaged or piston by piston"
  Interfaces.HydraulicPort port_a "Port A: a pump that turns positively delivers here; oil that is fed in here turns a motor negatively";
  Interfaces.HydraulicPort port_b "Port B: a pump that turns positively draws here; oil that is fed in here turns a motor positively";
  Interfaces.RotationalFlange flange "Shaft";
  parameter SI.Volume V = 0.8e-6 "Displacement per revolution";
  SI.AngularVelocity w(nominal = 100) "Speed of the shaft";
  SI.Pressure dp(nominal = 1e6) "Pressure of A above B";
  SI.VolumeFlowRate Q_A(nominal = 1e-5) "Volume flow out of port A";
  SI.Torque T_sh(nominal = 1) "Torque that the shaft gives to the machine";
end PumpPorts;
