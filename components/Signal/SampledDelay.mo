within Signal;
block SampledDelay "Delay by a number of sampling periods"
  extends Bases.Sampled(y(start = y_start, fixed = true));
  parameter Integer n(min = 1) = 2 "Number of periods";
  parameter Real y_start = 0 "Output before";
protected
  discrete Real x[n + 1](each start = y_start, each fixed = true) "Last inputs";
equation
  when tick then
    x[1] = u;
    for i in 2:n + 1 loop
      x[i] = pre(x[i - 1]);
    end for;
    y = x[n + 1];
  end when;
  annotation(Documentation(info = "<html><p>The input of n samples ago.</p></html>"));
end SampledDelay;
