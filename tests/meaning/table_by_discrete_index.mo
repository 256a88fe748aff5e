//! model P.M
//! y(0.2) = 2
//! y(0.8) = 3
//! z(0.8) = 30
// a constant table of a package read at an index that changes during the run; lists and types of packages
package P
  type Level = enumeration(Low, High);
  package Tables
    constant Integer Next[Level, 2] = [1, 2; 3, 4];
    constant Real Factor[:] = {10, 20, 30};
  end Tables;
  model M
    Level level;
    Integer k = 1;
    Integer y;
    Real z = Tables.Factor[y];
  equation
    level = if time > 0.5 then Level.High else Level.Low;
    y = Tables.Next[level, if time > 0.5 then k else 2];
  end M;
end P;
