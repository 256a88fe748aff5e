//! E015 at 3: "`Hydraulic.Bases.Storage.Air` cannot take the place of `Hydraulic.EntrainedAir.Law`"
model M
  Hydraulic.Volume volume(redeclare model Air = Hydraulic.Orifice);
  Hydraulic.FlowSource source;
equation
  connect(volume.port, source.port);
end M;
