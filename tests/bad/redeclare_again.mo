//! E015 at 13: "is not replaceable any more"
model M
  model A
    Real x = 1;
  end A;
  model Base
    replaceable A part;
  end Base;
  model Middle
    extends Base(redeclare A part);
  end Middle;
  model Last
    extends Middle(redeclare A part);
  end Last;
  Last last;
end M;
