model DeadZoneRig "The dead-zone rig with a recorded command of speed"
  extends ServoPump.DeadZone(
    redeclare ServoPump.IdealDrive motor, break rotor, break speed, break connect(speed.y, motor.w_ref),
    break connect(motor.flange, rotor.flange_a), break connect(rotor.flange_b, pump.flange));
  Interfaces.RealInput w_ref(unit = "rad/s", nominal = 3) "Command of speed";
equation
  connect(motor.flange, pump.flange);
  connect(w_ref, motor.w_ref);
end DeadZoneRig;
