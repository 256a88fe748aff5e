//! h(1) = 40
//! t2(1) = 5
// each of two parameters is given by the other one, and a third one says which of them is given
model M
  parameter Boolean useT = true;
  parameter Real T = if useT then 10 else h0/4;
  parameter Real h0 = if useT then 4*T else 1;
  parameter Boolean useT2 = false;
  parameter Real T2 = if useT2 then 10 else h2/4;
  parameter Real h2 = if useT2 then 4*T2 else 20;
  Real h = h0*time;
  Real t2 = T2*time;
end M;
