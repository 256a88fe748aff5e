model Neat "As it should be"
  Real x = 1;
end Neat;
