//! E027 at 6: "`break` stands in no loop"
model M
  Real x = time;
algorithm
  if x > 3 then
    break;
  end if;
end M;
