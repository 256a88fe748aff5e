//! model P.M
//! k(0.89) = 3
//! g(0.17) = 1.19
//! g(0.63) = 4.41
//! n(0.89) = 5
//! b(0.89) = 1
package P "String parameters"
  function pick
    input String name;
    output Real k;
  algorithm
    if name == "oil" then
      k := 3;
    elseif name == "water" then
      k := 4;
    else
      k := 0;
    end if;
  end pick;
  model Sub
    parameter String medium = "water";
    parameter Real k = pick(medium);
  end Sub;
  model M
    parameter String m = "oi" + "l";
    parameter String tab[2] = {"oil", "water"};
    Sub s(medium = m);
    Sub s2;
    Real k = s.k;
    Real g = (pick(tab[1]) + s2.k)*time;
    parameter String e = String(5) + "x" + String(true);
    Integer n = if e == "5xtrue" then 5 else 0;
    Boolean b = tab[2] > tab[1];
  equation
    assert(time >= 0, "bad " + m + String(time));
  end M;
end P;
