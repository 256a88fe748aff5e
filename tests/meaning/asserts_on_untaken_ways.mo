//! y(1) = 2
//! z(1) = 3
//! w(1) = 5
// a function fails in a branch that the run does not take; a function without outputs is called for what it asserts
model M
  function fail
    input String s;
  algorithm
    assert(false, s, AssertionLevel.error);
  end fail;
  function f
    input Real x;
    output Real y;
  protected
    String words;
  algorithm
    if x < 0 then
      words := "negative: ";
      fail(words + String(x));
    end if;
    y := 2*x;
  end f;
  function g
    input Real x;
    output Real y;
  algorithm
    if x < 1 then
      y := x + 2;
    else
      y := 3;
      assert(x < 2, "too large");
    end if;
  end g;
  function check
    input Real x[:];
  protected
    Integer n = size(x, 1);
    String text;
  algorithm
    for i in 1:n loop
      assert(x[i] >= 0, "negative");
    end for;
    if sum(x) > 100 then
      text := "";
      for i in 1:n loop
        text := text + String(x[i]);
      end for;
      fail("too much: " + text);
    end if;
  end check;
  Real y = f(time);
  Real z = g(time);
  Real w = 5*time;
equation
  check({time, 2*time});
end M;
