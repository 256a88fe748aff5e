//! E401 at 4: "`a.p` starts at 1000000 by `a.p_start`"
model M
  inner Oil.ISOVG46 oil;
  Hydraulic.Volume a(p_start = 1e6);
  Hydraulic.Volume b(p_start = 2e6);
equation
  connect(a.port, b.port);
end M;
