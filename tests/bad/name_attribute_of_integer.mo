//! E012 at 4: "`unit` is not an attribute of `Integer`"
//! E012 at 5: "attributes are: start, fixed, quantity"
model M "what only a Real has"
  Integer n(unit = "1") = 1;
  Boolean b(min = false) = true;
end M;
