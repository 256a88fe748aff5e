within ServoPump;
model SwitchedDrive "Sampled speed controller and encoder on the PMSM with sampled current control and a switching inverter"
  extends SampledFieldOrientedDrive(
    motor(
      redeclare Electrical.Drives.SampledCurrentControl control,
      redeclare Electrical.Drives.SwitchingInverter inverter));
end SwitchedDrive;
