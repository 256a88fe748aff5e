//! stop 3
//! on(0.9) = 0
//! on(1.2) = 1
//! on(2.1) = 0
//! last(2.1) = 2
// two whens of an algorithm assign one variable: of those that fire at once the last one counts
model M
  Boolean on(start = false, fixed = true);
  Integer last(start = 0, fixed = true);
algorithm
  when time > 1 then
    on := true;
  end when;
  when time > 2 then
    on := false;
  end when;
algorithm
  when time > 2 then
    last := 1;
  end when;
  when time > 2 then
    last := 2;
  end when;
end M;
