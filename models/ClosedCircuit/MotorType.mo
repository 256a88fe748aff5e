within ClosedCircuit;
type MotorType = enumeration(
  A "Soft: rotor resistance 0.40 ohm",
  B "Stiff: rotor resistance 0.16 ohm") "Induction motor of the drive";
