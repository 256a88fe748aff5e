//! turns(0.99) = 0
//! turns(1) = 1
//! below(1) = 1
model M "A sine that no state follows crosses zero exactly at the stop time"
  Integer turns(start = 0, fixed = true);
  Real below = if sin(3.141592653589793*time) >= 0 then 0 else 1;
equation
  when sin(3.141592653589793*time) < 0 then
    turns = pre(turns) + 1;
  end when;
end M;
