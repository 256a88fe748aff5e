//! n(0.49) = 0
//! n(1) = 1
//! x(1) = 1.6651092
//! narrow(1) = 1
//! root(1) = 1
//! called(1) = 1
model M "Single bells away from the steps: of 0.2 ms, of 2 ns, a cusp and one without bounds"
  function bell "Too much for bounds: its top is found from samples"
    input Real t;
    output Real y;
  protected
    Real a;
  algorithm
    a := 0;
    while a < 1 loop
      a := a + 1;
    end while;
    y := a/(1 + ((t - 0.70113)/1e-4)^2);
  end bell;
  Real u = exp(-((time - 0.50123)/1e-4)^2);
  Real x(start = 0, fixed = true) "2e-4 s sqrt(log(2)), in ten thousandths of a second";
  Integer n(start = 0, fixed = true);
  Integer narrow(start = 0, fixed = true);
  Integer root(start = 0, fixed = true);
  Integer called(start = 0, fixed = true);
equation
  der(x) = if u > 0.5 then 1e4 else 0;
  when u > 0.5 then
    n = pre(n) + 1;
  end when;
  when exp(-((time - 0.30117)/1e-9)^2) > 0.5 then
    narrow = pre(narrow) + 1;
  end when;
  when sqrt(noEvent(abs(time - 0.60091))) < 1e-4 then
    root = pre(root) + 1;
  end when;
  when bell(time) > 0.5 then
    called = pre(called) + 1;
  end when;
end M;
