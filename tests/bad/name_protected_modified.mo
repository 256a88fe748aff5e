//! E012 at 9: "`k` of `P.A` is protected"
//! model P.M
package P
  model A
  protected
    parameter Real k = 2;
  end A;
  model M
    A a(k = 3);
  end M;
end P;
