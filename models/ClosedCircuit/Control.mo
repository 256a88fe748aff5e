within ClosedCircuit;
type Control = enumeration(
    V_f "Voltage in proportion to frequency",
    SFVC "Sensorless flux vector control") "Control of the drive";
