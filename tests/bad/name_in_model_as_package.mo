//! E011 at 9: "which is no package"
model M
  model A
    Real x = 2;
    model B
      Real y = 3;
    end B;
  end A;
  A.B b;
end M;
