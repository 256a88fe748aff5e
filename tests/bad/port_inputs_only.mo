//! E106 at 3: "`first.u`"
model M
  Signal.Gain first;
  Signal.Gain second;
equation
  connect(first.u, second.u);
end M;
