//! E020 at 5: "`sinn`"
model M
  Real x;
equation
  x = sinn(time);
end M;
