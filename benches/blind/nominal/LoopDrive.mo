model LoopDrive "The closed circuit in its reduced form with recorded commands"
  extends ClosedCircuit.Reduced(
    steady = false,
    break frequency, break connect(frequency.y, inverter.f_ref), break connect(frequency.y, synchronous.u),
    break command, break connect(command.y, load.u));
  Interfaces.RealInput f_ref(unit = "Hz", nominal = 30) "Command of frequency";
  Interfaces.RealInput u_load(unit = "V", nominal = 3) "Command of the load";
equation
  connect(f_ref, inverter.f_ref);
  connect(u_load, load.u);
end LoopDrive;
