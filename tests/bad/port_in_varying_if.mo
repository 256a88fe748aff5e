//! E212 at 6: "before the run"
model M
  Signal.Constant source;
  Signal.Gain gain;
equation
  if time > 1 then
    connect(source.y, gain.u);
  end if;
end M;
