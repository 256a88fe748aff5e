within Smooth;
function pos "Positive part of x, rounded: w ln(1 + exp(x/w))"
  input Real x "Argument";
  input Real w(min = 0) "Width, in the unit of x";
  output Real y "Positive, x for x >> w";
algorithm
  y := max(x, 0) + w*log(1 + exp(-abs(x)/w));
  annotation(Inline = true, Documentation(info = "<html><p>Written so that no exponential overflows.</p></html>"));
end pos;
