model DeadZoneRig "The dead-zone rig with a recorded command of speed"
  extends ServoPump.DeadZone(break speed, break connect(speed.y, motor.w_ref));
  Interfaces.RealInput w_ref(unit = "rad/s", nominal = 3) "Command of speed";
equation
  connect(w_ref, motor.w_ref);
end DeadZoneRig;
