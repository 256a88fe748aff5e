within Electrical.Drives;
model ZeroDirectCurrent "Torque by the current of the q axis alone"
  extends CurrentCommand;
equation
  i_d_ref = 0;
  i_q_ref = T/(1.5*p*psi_f);
  annotation(Documentation(info = "<html><p><code>i_d = 0</code>, <code>i_q = T/(3/2 p psi_f)</code>: the least current for magnets on the surface of the rotor (<code>L_d = L_q</code>). Beyond the base speed the voltage ends and the torque with it.</p></html>"));
end ZeroDirectCurrent;
