//! E105 at 8: "cannot be joined"
model M
  Signal.GreaterThreshold switch(threshold = 1);
  Signal.Gain gain;
  Signal.Constant constant_(k = 2);
equation
  connect(constant_.y, switch.u);
  connect(switch.y, gain.u);
end M;
