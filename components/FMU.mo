partial model FMU "Functional mock-up unit: a controller or model of another tool"
  parameter String file "The unit; a relative path begins at the folder of the model's file";
  parameter String kind = "auto" "cs: Co-Simulation, stepped beside the circuit; me: Model Exchange, solved with it; auto: cs where the unit has it";
protected
  class Unit "The unit"
    extends ExternalObject;
    function constructor "Reads and loads it"
      input String file;
      input String kind;
      input String texts "Values of its texts";
      output Unit unit;
    external "C" unit = bramah_mockup(file, kind, texts);
    end constructor;
    function destructor "Nothing: what is not used any more goes by itself"
      input Unit unit;
    external "C" bramah_mockup_free(unit);
    end destructor;
  end Unit;
  function begin "The state before anything is done"
    input Unit unit;
    input Real settings[:] "Parameters";
    output Real root;
  external "C" root = bramah_mockup_begin(unit, settings);
  end begin;
  function start "Continuous states and discrete outputs at the start"
    input Unit unit;
    input Integer count "How many";
    input Real root "Its first state";
    input Real t "Time";
    input Real given[:] "Inputs";
    output Real found[count];
  external "C" bramah_mockup_start(unit, root, t, given, found);
  end start;
  function advance "Co-Simulation: the state and the outputs at the next communication point"
    input Unit unit;
    input Integer count "How many";
    input Real state "Its state";
    input Real last "The last communication point";
    input Real t "Time";
    input Real held[:] "Inputs there";
    output Real found[count];
  external "C" bramah_mockup_advance(unit, state, last, t, held, found);
  end advance;
  function evaluate "Model Exchange: derivatives, event indicators, outputs"
    input Unit unit;
    input Integer count "How many";
    input Real state "Its state";
    input Real t "Time";
    input Real states[:] "Continuous states";
    input Real given[:] "Inputs";
    output Real found[count];
  external "C" bramah_mockup_evaluate(unit, state, t, states, given, found);
  end evaluate;
  function event "Model Exchange: state, next event, continuous states, discrete outputs after an event"
    input Unit unit;
    input Integer count "How many";
    input Real state "Its state";
    input Real t "Time";
    input Real states[:] "Continuous states";
    input Real given[:] "Inputs";
    output Real found[count];
  external "C" bramah_mockup_event(unit, state, t, states, given, found);
  end event;
  annotation(Documentation(info = "<html><p><code>FMU controller(file = \"controller.fmu\")</code> makes a component of a unit after FMI 2.0 or 3.0. Its inputs, outputs and parameters have the names that the unit gives them, in SI units with the unit's own units shown; a name that is none of Modelica stands in quotes, as in <code>controller.'pump.speed'</code>.</p>
<p>As Co-Simulation the unit is called at communication points, <code>step</code> apart: it takes its inputs there, and its outputs are known at the next point and hold until the one after, as those of a sampled controller that computes during one period. As Model Exchange its equations are solved with those of the circuit, and its events are events of the run; it is not asked after each step of the integrator. Several runs of one circuit have their own instances of a unit.</p></html>"));
end FMU;
