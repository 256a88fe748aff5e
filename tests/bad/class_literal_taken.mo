//! E027 at 3: "`fixed` cannot be a literal"
model M
  type E = enumeration(loose, fixed);
  E e = E.loose;
end M;
