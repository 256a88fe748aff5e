//! E027 at 7: "`c` is `flow` inside and outside"
model M
  connector C
    Real e = 1;
    flow Real f;
  end C;
  flow C c;
end M;
