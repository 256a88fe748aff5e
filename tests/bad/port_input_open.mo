//! E106 at 3: "input `gain.u`"
model M
  Signal.Gain gain;
  Real x = gain.y;
end M;
