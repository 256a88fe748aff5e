//! E027 at 7: "`P.q` belongs to no component"
package P
  Real q;
  model M
    Real y;
  equation
    y = P.q;
  end M;
end P;
