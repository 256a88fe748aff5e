within;
package Effects "Physics that a model may lack: each model attaches to a network by the interface that it extends"
  import Modelica.Units.SI;
  annotation(Documentation(info = "<html>
<p>An effect holds no ports. It gets potentials as inputs and gives a flow (or gets and gives a signal), so that it fits any connector of
the same units. Which variable is what is said by the interface:</p>
<pre>__bramah(attach = \"Shunt|Bridge|Drain|Series|Sensor|Command\", potential = {...}, through = \"...\", drop = \"...\", sense = {...})</pre>
<p>A Shunt draws <code>through</code> from a node; a Bridge lets it pass from the first to the second port of a component; a Drain from a node to
one of constant potential; a Series element cuts a connection, gets the flow and gives the fall of the potential. A Series
element is given <code>through</code> and gives <code>drop</code>. <code>sense</code> names potentials of further ports of the same component. With
<code>anywhere = \"yes\"</code> they are those of any other; a Bridge that senses nothing lies between any two places with it.</p>
<p>An effect adds</p>
<pre>__bramah(family = \"...\", id = \"E27\", coefficients = {\"F_c\"}, shapes(v_s = {0.002, 0.02}), base = {\"d\"}, relative = {\"b\"},
  threshold = {\"p_o\"}, level = {\"p_o\"}, limit = {\"m\"}, order = {\"n\"}, part = {\"C\"}, own = {\"a_s\"}, range = {\"s\", \"s_min\", \"s_max\"}, surroundings = \"p_0\", temperature = \"T\", group = \"...\", law = \"...\", ends = \"free\", directed = \"yes\", measured = \"yes\", without = \"Drain\")</pre>
<p>Coefficients have the off value 0 at which the effect vanishes exactly, <code>nominal</code> is their typical size on a usual bench and
<code>min = 0</code> stands where the sign counts. Shapes enter nonlinearly and are tried on the grid given. A parameter in <code>base</code> takes the value
of the parameter of equal unit of the component to which the effect is attached. Coefficients and shapes in <code>relative</code> count in full
scales of the signal; shapes in <code>threshold</code> are compared with the potential (or its difference), so that only values within its range make sense,
those in <code>level</code> with the first potential alone, and neither is tried where values lie beyond <code>min</code> or <code>max</code>;
shapes in <code>limit</code> are compared with the size of the signal; an effect with a shape in <code>order</code> may come again with another one. A coefficient in <code>part</code> is at most what its node has already: the flow
over the rate of the potential that it causes at once. A coefficient in <code>own</code> has another value in each recording (where in its period what
follows nothing begins). <code>range</code> names a potential, or what flows through a Series element, and the two parameters that take the least and greatest value
that it has in the recordings. <code>surroundings</code> names the parameter that is the pressure outside: 0 where the model counts pressures from there. A shape with one value that has the unit of a speed, of the potential or of what flows through a Series element is a corner: it is at most 2 % of the greatest value at its place. A shape in m or rad is a distance: it is also tried in decades below and above those given, up to the travel of its place. Times are written for samples a millisecond apart and grow with slower ones.
<code>temperature</code> is given an input in kelvin. Effects of one <code>group</code> are also tried together with one set of coefficients; those of one
<code>law</code> are forms of it, of which a place has one. What the package names first is the more usual on machines: it stands first where data do not decide. A Bridge
with free ends is not tried towards a fixed potential, a directed one both ways round; an effect of a command that is <code>measured</code> is also tried where a sensor shows the input; <code>without</code> an interface: only where no effect of the family
fits by that one. Laws are smooth, with the width given. An effect with states of its own has them as variables with a
derivative.</p></html>"));
end Effects;
