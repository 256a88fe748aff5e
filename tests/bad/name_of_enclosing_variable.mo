//! E011 at 8: "only constants of enclosing classes can be read"
model M
  model A
    Real x = 3;
    model B
      Real y;
    equation
      y = x;
    end B;
    B b;
  end A;
  A a;
end M;
