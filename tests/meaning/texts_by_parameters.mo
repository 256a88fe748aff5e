//! model P.M
//! y(0.5) = 4.5
//! z(0.5) = 3
//! named(0.5) = 1
//! w(0.5) = 3
package P "texts that parameters choose"
  type Color = enumeration(red, green, blue);
  function nameOf
    input Color c;
    output String s;
  algorithm
    s := if c == Color.red then "r" else if c == Color.green then "g" else "b";
  end nameOf;
  function medium
    input Boolean hot;
    output String s;
  algorithm
    if hot then
      s := "steam";
    else
      s := "water";
    end if;
  end medium;
  function density
    input String name;
    output Real rho;
  algorithm
    rho := if name == "water" then 4 elseif name == "steam" then 3 else 0;
  end density;
  model Filled
    parameter String name = "none";
    Real rho = density(name);
  end Filled;
  model M
    parameter Color k = Color.green;
    parameter Boolean hot = true;
    parameter String fluid = if hot then "steam" else "water";
    Filled a(name = medium(not hot));
    Filled b(name = fluid);
    Real y = a.rho + time;
    Real z = b.rho;
    Boolean named = nameOf(k) == "g";
    Real w = density(if k == Color.red then "water" else "steam");
  end M;
end P;
