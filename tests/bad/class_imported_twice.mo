//! E027 at 4: "`Volume` is imported twice"
model M
  import Hydraulic.Volume;
  import Volume = Hydraulic.Orifice;
  Real x = 1;
end M;
