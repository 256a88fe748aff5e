//! E105 at 12: "joined ports need one value"
model M
  connector C
    Real e;
    flow Real f;
    parameter Real k = 1;
  end C;
  model Box
    C c1(k = 1), c2(k = 2);
  equation
    c1.e = 1;
    connect(c1, c2);
  end Box;
  Box box;
end M;
