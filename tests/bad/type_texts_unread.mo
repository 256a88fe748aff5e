//! E210 at 13: "`s` is a String and cannot take an Integer"
//! E210 at 14: "`t` is a String and cannot take an array of size [1]"
//! E213 at 15: "`u` has no value"
//! E210 at 16: "`a.name` is a String and cannot take a Boolean"
//! E210 at 17: "`unit` of `x` is a String and cannot take an Integer"
//! E210 at 18: "`x.fixed` is a Boolean and cannot take an Integer"
//! E211 at 19: "an array of 2 elements is needed here, and this is an array of size [3]"
//! E211 at 20: "an array of 2 elements is needed here, and this is an array of size [3]"
model M "what is never read must fit all the same"
  model A
    parameter String name = "a";
  end A;
  parameter String s = 3;
  parameter String t = {"a"};
  parameter String u;
  A a(name = true);
  Real x(unit = 1,
    fixed = 1) = time;
  parameter Real k[2] = {1, 2, 3};
  parameter String names[2] = {"a", "b", "c"};
end M;
