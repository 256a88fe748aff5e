//! E210 at 5: "`n` is an Integer and is given a value that changes all the time"
model M
  Integer n;
equation
  n = 2*time;
end M;
