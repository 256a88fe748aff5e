//! E215 at 3: "`volume.air.tau_d` is -1 s, less than its `min`"
model M
  Hydraulic.Volume volume(redeclare model Air = Hydraulic.EntrainedAir.Dissolving(tau_d = -1));
  Hydraulic.FlowSource source;
equation
  connect(volume.port, source.port);
end M;
