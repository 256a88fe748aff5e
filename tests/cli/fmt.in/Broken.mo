model Broken
  Real x = ;
end Broken;
