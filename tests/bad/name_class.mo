//! E010 at 3: "`Hydraulic` has no class `Orrifice`"
model M
  Hydraulic.Orrifice orifice;
end M;
