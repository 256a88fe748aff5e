within;
package Smooth "Regularised sign, magnitude, step, positive part and clip: continuous with a continuous derivative, exact far from the kink"
  annotation(Documentation(info = "<html>
<p>Every kink of a hydraulic law that is not an event of its own is rounded by one of these functions. The width <code>w</code> is given by the
caller and documented there: it should stay under a tenth of the smallest amplitude of interest, and above what the time constant of the
regularised element needs (width of a sign function times inertia over friction torque, for instance, at least some milliseconds).</p></html>"));
end Smooth;
