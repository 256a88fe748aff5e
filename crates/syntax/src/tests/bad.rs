//! Texts with mistakes that authors make, and the messages they get (in the snapshot).

use super::messages;
use std::fmt::Write;

const TEXTS: &[&str] = &[
    // Semicolons.
    "model A\n  Real x\n  Real y;\nend A;",
    "model A\n  Real x;\nequation\n  x = 1\n  y = 2;\nend A;",
    "model A\nequation\n  x = 1\nend A;",
    "model A\nequation\n  x = a\n    b;\n  y = 1;\nend A;",
    "model A\nequation\n  x = 1 y = 2;\nend A;",
    "model A Real x; end A",
    "model A\n  Real x;;\nend A;",
    "within P\nmodel A end A;",
    "model A\n  import B\n  extends C\n  Real x;\nend A;",
    // Ends.
    "model A\n  Real x;\nend B;",
    "model A\n  Real x;\nend;",
    "model A\n  Real x;\n",
    "package P\n  model A\n    Real x;\n  model B\n  end B;\nend P;",
    "model A\nequation\n  if a then\n    x = 1;\nend A;",
    "model A\nequation\n  for i in 1:2 loop\n    x[i] = 1;\n  end if;\nend A;",
    "model A\nequation\n  if a then\n    for i in 1:2 loop\n      x[i] = 1;\n  end if;\n  y = ;\nend A;",
    "model A\nequation\n  if a then\n    x = 1;\n  end;\nend A;",
    "model A\nequation\n  if a then\n    x = 1;\n  else if b then\n    x = 2;\n  else\n    x = 3;\n  end if;\nend A;",
    "model A\nequation\n  if a then\n    x = 1;\n  elif b then\n    x = 2;\n  endif;\nend A;",
    "model A\nequation\n  x = 1;\n  end if;\n  y = 2;\nend A;",
    "model A\nequation\n  x = 1;\nelse\n  y = 2;\nend A;",
    "model A\nequation\n  if a then x = 1; else x = 2; else x = 3; end if;\nend A;",
    "model A\nequation\n  x = 1;\nend A;\n  y = 2;\nend A;",
    "model A\n  Real x;\nequation\n  x = 1;\nend A;\n\nRealy y;",
    "model A\n  end Real x;\n  Real y;\nequation\n  end x = 1;\nend A;",
    "package P\n  model A\n  equation\n    if a then\n      for i in 1:2 loop\n        x = 1;\n  end A;\n  model B\n    Real;\n  end C;\nend P;",
    "model A\nequation\n  parameter Real x;\n  parameter Real y;\n  z = 1;\nend A;",
    // Brackets, strings, comments.
    "model A\n  Real x(start = 1;\n  Real y;\nend A;",
    "model A\nequation\n  x = (a + b;\n  y = f(1, 2;\n  z = {1, 2;\n  w = a[1;\nend A;",
    "model A\nequation\n  x = [1, 2; 3, 4;\n  y = 2;\nend A;",
    "model A\nequation\n  x = (a + b];\n  y = a);\nend A;",
    "model A\n  Real x \"position;\n  Real y \"speed\";\nequation\n  x = ;\nend A;",
    "model A\n  Real x \"position;\nend A;",
    "model A\n  Real x;\n  /* a comment\nequation\n  x = 1;\nend A;",
    "model A\n  Real 'x;\n  Real y;\nend A;",
    "model A \"a \"good\" model\" end A;",
    "model A\n  parameter String s = \"a\\q\";\nend A;",
    // Signs.
    "model A\nequation\n  x := 1;\n  x == 1;\n  x <- 1;\nend A;",
    "model A\nalgorithm\n  x = 1;\n  x == 1;\n  x <- 1;\n  (a, b) = f(1);\nend A;",
    "model A\nalgorithm\n  x + 1 := 2;\n  x;\n  (a, b) := 1;\n  connect(a, b);\nend A;",
    "model A\n  Real x == 1;\n  Real y(start == 1);\nend A;",
    "model A\nequation\n  if x = 1 then\n    y = 1;\n  end if;\n  y = if x = 1 then 1 else 2;\nend A;",
    "model A\nequation\n  b = a && c || !d;\n  b = a != c;\n  y = x ** 2;\nend A;",
    "model A\nequation\n  y = 2^-1;\n  y = a * -b;\n  y = a - -b;\n  b = c == not d;\n  y = a^b^c;\n  b = a < b < c;\nend A;",
    "model A\nequation\n  y = 1 + if a then 1 else 2;\n  y = if a then 1;\n  y = if a 1 else 2;\nend A;",
    "model A\nequation\n  y = 10 mm;\n  y = 10mm;\n  y = 1e400;\n  y = 3 x;\nend A;",
    "model A\nequation\n  y = a + ;\n  y = * a;\n  y = f(a, );\n  y = {};\n  = 3;\n  y;\nend A;",
    "model A\nequation\n  y = 3; # comment\n  z = a % b;\n  w = 2 \u{2212} 1;\n  \u{f6}l = 3;\nend A;",
    "model A\n  Real x; // fine\n  Real y \u{201c}text\u{201d};\n  Real z; $\nend A;",
    "model A\nequation\n  y = f(a = 1, 2);\n  y = x[];\n  y = a.;\n  y = a.1;\n  y = end;\nend A;",
    // Blocks.
    "model A\nequation\n  if a\n    x = 1;\n  end if;\n  when b\n    x = 2;\n  end when;\nend A;",
    "model A\nequation\n  if (a > ) then\n    x = 1;\n  else\n    x = 2;\n  end if;\nend A;",
    "model A\nequation\n  for i = 1:3 loop\n    x[i] = 1;\n  end for;\n  for i in 1:3 do\n    x[i] = 1;\n  end for;\nend A;",
    "model A\nalgorithm\n  while a do\n    x := 1;\n  end while;\n  for 1:3 loop\n    x := 1;\n  end for;\nend A;",
    "model A\nequation\n  connect(a.b);\n  connect(a, 1);\n  connect a, b;\nend A;",
    // Declarations.
    "model A\n  Real model;\n  parameter Real end = 1;\n  Real x, input;\n  Real 2x;\nend A;",
    "model A\n  parameter final Real x = 1;\n  input flow Real y;\n  parameter constant Real z;\n  outer inner B b;\nend A;",
    "model A\n  Real x y;\n  Real;\n  Real = 3;\n  x = 4;\nend A;",
    "model A\n  Real x;\n  x = 1;\n  connect(a, b);\nend A;",
    "model A\n  Real x;\n  x := 1;\n  while a loop\n  end while;\nend A;",
    "model A\nequation\n  x = 1;\n  Real y;\n  parameter Real z;\n  y = 2;\nend A;",
    "model A\n  Real x(start 1);\n  Real y(start);\n  Real z[3](start[1] = 2);\n  B b(each redeclare C c);\n  B b(break c);\nend A;",
    "model A\n  B b(redeclare model C Real x; end C);\n  B b(x = 1, , y = 2);\nend A;",
    "model A\n  annotation(x = 1);\n  Real y;\nend A;",
    "model A\n  annotation;\n  import B.;\n  import B.{c d};\n  extends;\nend A;",
    "model\n  Real x;\nend A;",
    "mode1 A\n  Real x;\nend A;",
    "partial A end A; pure model B end B; expandable model C end C;\nmodel D end D;",
    "type E = enumeration(a b); type F = enumeration a; function f = der(g); model M = ;",
    "function f\n  external \"C\" y = ;\nend f;",
    "model A\n  Real x if ;\n  replaceable B b constrainedby;\n  Real[ x;\nend A;",
    "Real x;\nequation\n  x = 1;",
    "{ \"json\": [1, 2, 3] }",
    "time,x,y\n0,1,2\n1,2,3\n",
    "<html><body>text</body></html>",
];

#[test]
fn mistakes_get_their_messages() {
    let mut out = String::new();
    for text in TEXTS {
        let messages = messages(text);
        assert_ne!(messages, "", "no message about\n{text}");
        writeln!(out, "{text}\n-----\n{messages}=====").expect("writing to a string succeeds");
    }
    insta::assert_snapshot!(out);
}
