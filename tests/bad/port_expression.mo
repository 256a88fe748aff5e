//! E001 at 5: "expected"
model M
  Signal.Gain gain;
equation
  connect(2*time, gain.u);
end M;
