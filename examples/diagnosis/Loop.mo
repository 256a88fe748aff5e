model Loop "Pump drives motor in a closed hydraulic circuit, with recorded commands of drive and load"
  extends ClosedCircuit.Reduced(
    steady = false,
    break frequency, break connect(frequency.y, inverter.f_ref), break connect(frequency.y, synchronous.u),
    break command, break connect(command.y, load.u));
  Interfaces.RealInput f_ref(unit = "Hz", nominal = 30) "Frequency command of the pump's inverter";
  Interfaces.RealInput u_load(unit = "V", nominal = 3) "Command of the load machine";
equation
  connect(f_ref, inverter.f_ref);
  connect(u_load, load.u);
end Loop;
