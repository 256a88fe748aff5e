//! E011 at 9: "is protected"
model M
  package P
  protected
    model A
      Real x = 1;
    end A;
  end P;
  P.A a;
end M;
