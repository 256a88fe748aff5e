//! model P.M
//! stop 3
//! x(0.51) = 0.51
//! x(1.89) = 10.89
//! n(0.51) = 0
//! n(1.89) = 1
package P
  model M
    Real x(start = 0, fixed = true);
    Integer n(start = 0, fixed = true);
  equation
    der(x) = 1;
    when sample(1, 1) then
      n = pre(n) + 1;
      if pre(n) == 0 then
        reinit(x, 10);
      else
        reinit(x, n*10);
      end if;
    end when;
  end M;
end P;
