within ServoPump;
partial model Drive "Speed-controlled servo drive: torque for a commanded speed"
  Interfaces.RealInput w_ref(unit = "rad/s") "Command of speed";
  Interfaces.RotationalFlange flange "Shaft";
  SI.Torque T_e "Torque of the motor";
  SI.AngularVelocity w_meas(nominal = 100) "Measured speed";
end Drive;
