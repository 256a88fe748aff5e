//! model M
//! E104 at 16: "T"
connector Simple
  Real p;
  flow Real q;
end Simple;
connector Heated
  Real p;
  Real T;
  flow Real q;
end Heated;
model M
  Simple a;
  Heated b;
equation
  connect(a, b);
end M;
