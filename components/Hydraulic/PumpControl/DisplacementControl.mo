within Hydraulic.PumpControl;
model DisplacementControl "Displacement control: the swash plate follows an electric command, over centre too; below a pressure cut-off"
  extends Law(u_min = -1, u_start = 0);
  Interfaces.RealInput command(unit = "1") "Displacement commanded over the greatest one";
equation
  u_p = min((p_set - p)/droop, command);
  annotation(Documentation(info = "<html><p>The displacement follows the command with the lag <code>tau</code> and at most full stroke in <code>T_up</code> and <code>T_down</code>, between <code>u_min</code> and <code>u_max</code>, by default from full stroke one way to full stroke the other way. The pressure cut-off and the limit of torque see <code>port_p</code>, the high side for positive displacement; near <code>p_set</code> they swing the plate back, and above it even over centre, to <code>u_min</code>: in open circuits set <code>u_min = 0</code>. In closed circuits the pressure of the other side is limited by relief valves. <code>T_up</code> holds towards greater u, <code>T_down</code> towards smaller. Source: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001, chapter 9.</p></html>"));
end DisplacementControl;
