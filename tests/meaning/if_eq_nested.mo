//! model P.M
//! stop 2
//! a(0.34) = 0.34
//! a(1.26) = 1
//! b(0.34) = 1
//! b(1.26) = 2
//! y[1](1.78) = 1
//! y[2](1.78) = 4
//! u(1.78) = 7
package P
  model M
    parameter Boolean lin = true;
    parameter Integer n = 2;
    Real a;
    Real b;
    Real y[n];
    Real u;
  equation
    if time < 1 then
      a = time;
      if time < 0.5 then
        b = 1;
      else
        b = 2;
      end if;
    else
      if time < 1.5 then
        b = 2;
      else
        b = 3;
      end if;
      a = 1;
    end if;
    for i in 1:n loop
      if i == 1 then
        y[i] = i;
      else
        y[i] = y[i - 1] + 3;
      end if;
    end for;
    if lin then
      u = 7;
    else
      der(u) = 1;
    end if;
  end M;
end P;
