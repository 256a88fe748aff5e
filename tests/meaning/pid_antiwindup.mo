//! stop 3
//! m(0.51) = 0
//! m(1.89) = 1
//! s(0.51) = 1
//! s(1.89) = -1
//! mm(0.51) = 0.47203054129
//! mm(1.89) = 0.3
//! ab(0.51) = 0.47203054129
//! ab(1.89) = 0.124895037117
//! r(0.51) = 1
//! r(1.89) = 1
model M "relations in all places"
  Real u = sin(5*time + 0.1);
  Integer m = if not (time < 1) then 1 else 0;
  Real s = if u >= 0 then 1 else -1;
  Real mm = max(u, 0.3);
  Real ab = abs(u);
  Real r = if time < 2 then 1 else if m == 1 and u < 2 then 5 else 9;
end M;
