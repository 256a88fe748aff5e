//! E210 at 5: "`d` is `discrete` and is given a value that changes all the time"
model M
  discrete Real d;
equation
  d = time;
end M;
