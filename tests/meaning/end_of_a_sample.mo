//! tolerance 1e-9
//! n(1) = 10
//! ends(1) = 10
//! ended(0.5) = 0.45
//! ended(1) = 0.95
//! direct(1) = 10
//! ups(1) = 10
//! turns(1) = 20
model M "A pulse of sample ends at its instant, which pre sees"
  Boolean c(start = false, fixed = true);
  Integer n(start = 0, fixed = true), ends(start = 0, fixed = true), direct(start = 0, fixed = true);
  Integer ups(start = 0, fixed = true), turns(start = 0, fixed = true);
  discrete Real ended(start = -1, fixed = true);
equation
  c = sample(0.05, 0.1);
  when c then
    n = pre(n) + 1;
  end when;
  when pre(c) and not c then
    ends = pre(ends) + 1;
    ended = time;
  end when;
  when sample(0.05, 0.1) then
    direct = pre(direct) + 1;
  end when;
  when edge(c) then
    ups = pre(ups) + 1;
  end when;
  when {c, not c} then
    turns = pre(turns) + 1;
  end when;
end M;
