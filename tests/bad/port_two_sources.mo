//! E105 at 8: "two outputs"
model M
  Signal.Constant first(k = 1);
  Signal.Constant second(k = 2);
  Signal.Gain gain;
equation
  connect(first.y, gain.u);
  connect(second.y, gain.u);
end M;
