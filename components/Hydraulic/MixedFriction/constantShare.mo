within Hydraulic.MixedFriction;
function constantShare "The share does not change with speed and pressure"
  extends Law;
algorithm
  w_f := w_0;
  annotation(Inline = true, Documentation(info = "<html><p>As DOI 10.1177/09544054221102779 has it, which finds the friction of its machines mostly fluid. The mechanical efficiency then does not fall at low speed.</p></html>"));
end constantShare;
