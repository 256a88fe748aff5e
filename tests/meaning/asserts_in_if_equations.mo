//! y(1) = 3
//! n(1) = 2
// a function called for what it asserts, in a branch that is not taken; a text that a branch decides
model M
  function check
    input Real x;
  algorithm
    assert(x < 0.5, "too large");
  end check;
  function f
    input Real x;
    output Real y;
    output String words;
  algorithm
    words := "small";
    if x > 0.5 then
      words := "large";
    end if;
    y := 3*x;
  end f;
  function g
    input Real x;
    output Real n;
  protected
    Real y;
    String words;
  algorithm
    (y, words) := f(x);
    n := y - x;
  end g;
  Real y;
  Real n = g(time);
equation
  if time < 0.4 then
    check(time);
    y = 2*time;
  else
    y = 3*time;
  end if;
end M;
