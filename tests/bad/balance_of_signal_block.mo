//! E201 at 2: "`Filter` has 0 equations but needs 1"
block Filter
  input Real u;
  output Real y;
end Filter;
model M
  Filter filter;
equation
  filter.u = time;
end M;
