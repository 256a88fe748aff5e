//! The list of diagnostic codes, one row each: name, number, default severity, title.
//! The number's first digit names the stage that finds it. `docs/errors` has a page for each code.
//!
//! 0 text and names, 1 ports and connections, 2 balance, units and types, 3 structure, 4 initialization, 5 run,
//! 6 data and studies, 9 command line.

/// How serious a message is, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing, although nothing is wrong.
    Note,
    /// Probably not what the user meant. The result can be used.
    Warning,
    /// The model or the run cannot be used.
    Error,
}

// Makes the enumeration of codes and its lookups from the rows below.
macro_rules! codes {
    ($($name:ident = $number:literal, $severity:ident, $title:literal;)*) => {
        /// A kind of diagnostic.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Code { $(#[doc = $title] $name,)* }

        impl Code {
            /// Every code, in the order of the list.
            pub const ALL: &'static [Code] = &[$(Code::$name,)*];

            /// The code as printed, such as `E103`.
            pub fn id(self) -> &'static str {
                match self { $(Code::$name => $number,)* }
            }

            /// What the code means, in a few words.
            pub fn title(self) -> &'static str {
                match self { $(Code::$name => $title,)* }
            }

            /// The severity it has unless told otherwise.
            pub fn severity(self) -> Severity {
                match self { $(Code::$name => Severity::$severity,)* }
            }
        }
    };
}

codes! {
    // 00x text
    Syntax = "E001", Error, "the text is not Modelica";
    UnterminatedText = "E002", Error, "a string, comment, bracket or block is not closed";
    WrongEnd = "E003", Error, "the name after `end` is not the class's name";
    TooDeep = "E004", Error, "the text is nested too deeply";
    NotText = "E005", Error, "the file is not text";
    // 01x names
    UnknownClass = "E010", Error, "no class of this name";
    UnknownName = "E011", Error, "no variable, parameter or component of this name";
    UnknownModifier = "E012", Error, "the modified element does not exist";
    Duplicate = "E013", Error, "declared twice";
    CyclicExtends = "E014", Error, "a class extends or contains itself";
    BadRedeclare = "E015", Error, "the redeclaration does not fit";
    NoInner = "E016", Error, "`outer` finds no `inner`";
    Unsupported = "E017", Error, "valid Modelica that bramah does not support";
    Partial = "E018", Error, "a partial class cannot be instantiated";
    FinalModified = "E019", Error, "a final element is modified";
    UnknownFunction = "E020", Error, "no function of this name";
    BadCall = "E021", Error, "the arguments do not fit the function";
    BadModel = "E022", Error, "no such model, or none that can run";
    BadSet = "E023", Error, "a value given from outside does not fit";
    WrongClassKind = "E024", Error, "a class of the wrong kind stands here";
    AutomaticInner = "N025", Note, "an `inner` component was added";
    Restricted = "E027", Error, "a class holds or extends what its kind does not allow";
    Shadowed = "N026", Note, "a class of the user hides one that ships with bramah";
    BadMockUp = "E029", Error, "a functional mock-up unit cannot be used";
    RunsC = "N030", Note, "C code of the model runs";
    OtherVersion = "W028", Warning, "a library of another version than the model says";
    // 1xx ports
    OpenPort = "E103", Error, "a port is not connected";
    DomainMismatch = "E104", Error, "ports of different domains are joined";
    BadConnect = "E105", Error, "this cannot be connected";
    NoInput = "E106", Error, "an input has no value";
    UnevenPort = "W107", Warning, "a connector has not as many flows as potentials";
    // 2xx balance, types, units
    Balance = "E201", Error, "a component has too few or too many equations";
    GlobalBalance = "E202", Error, "the model has too few or too many equations";
    TypeMismatch = "E210", Error, "a value of the wrong type";
    SizeMismatch = "E211", Error, "arrays of different size";
    NotConstant = "E212", Error, "a value must be known before the run";
    NoValue = "E213", Error, "a parameter without a value";
    CyclicParameter = "E214", Error, "parameters depend on each other cyclically";
    OutOfRange = "E215", Error, "a value outside `min` and `max`";
    BadIndex = "E216", Error, "an index outside the array";
    Evaluation = "E217", Error, "an expression cannot be evaluated";
    Recursion = "E218", Error, "recursion without end";
    TooLarge = "E219", Error, "the model is too large";
    UnitMismatch = "W230", Warning, "two sides of an equation have different units";
    UnitFactor = "W231", Warning, "two sides have the same dimension in different units";
    UnknownUnit = "W232", Warning, "a unit that cannot be read";
    // 3xx structure
    Singular = "E301", Error, "the equations do not determine the unknowns";
    NoReference = "E302", Error, "nothing fixes the level of a group of nodes";
    Overdetermined = "E303", Error, "a quantity is determined twice";
    IndexReduction = "E304", Error, "constraints that cannot be differentiated";
    ReinitNoState = "E305", Error, "`reinit` of something that is no state";
    HeldStill = "N306", Note, "a body cannot move";
    // 4xx initialization
    InitialOver = "E401", Error, "start values contradict each other";
    InitialUnder = "W402", Warning, "start values were chosen";
    StartMissed = "W404", Warning, "a start value that the constraints do not allow";
    InitialFailed = "E403", Error, "no consistent initial state";
    // 5xx run
    StepTooSmall = "E501", Error, "the step size collapsed";
    Chattering = "E502", Error, "events without end";
    AssertionFailed = "E503", Error, "an assertion does not hold";
    NonFinite = "E504", Error, "a value is not finite";
    AssertionWarning = "W505", Warning, "an assertion of level warning does not hold";
    EventFailed = "E506", Error, "no consistent state after an event";
    Interrupted = "E507", Error, "the run was interrupted";
    CallbackPanicked = "E508", Error, "a callback panicked";
    ImpulseLost = "E509", Error, "what is differentiated jumps";
    SharedLoad = "W510", Warning, "parts share a load in no unique way";
    RootJumped = "W511", Warning, "a loop jumps to another solution";
    // 6xx data
    BadData = "E601", Error, "a data file cannot be used";
    BadExperiment = "E602", Error, "an experiment file cannot be used";
    LargeResult = "N603", Note, "the result will be large";
    EventsThinned = "N610", Note, "not every event has rows";
    BadStudy = "E604", Error, "a study cannot be used";
    StuckSignal = "W605", Warning, "a recorded column never changes";
    BadCheckpoint = "E606", Error, "a run cannot go on from a checkpoint";
    WorseThanConstant = "W607", Warning, "a fitted signal is met worse than by a constant";
    SteppingInput = "W608", Warning, "an input that steps is joined by straight lines";
    ForeignColumn = "W609", Warning, "a column seems to have another sign or unit than the study says";
    TimeUnit = "W611", Warning, "a time column without a unit looks like no seconds";
    UnitsDiffer = "E612", Error, "the unit of a column is said twice, differently";
    InputsHeld = "N613", Note, "recorded inputs hold their samples";
    // 9xx command line
    BadArgument = "E901", Error, "an argument cannot be used";
    FileAccess = "E902", Error, "a file cannot be read or written";
    BadMap = "E903", Error, "inputs and columns do not fit";
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.id())
    }
}

impl Code {
    /// Advice that helps with every message of this code, for messages without more specific help.
    /// `None` if there is no such advice.
    pub fn advice(self) -> Option<&'static str> {
        Some(match self {
            Code::WrongClassKind => "see `bramah explain CLASS` for what a class is and holds",
            Code::UnknownFunction => "check the spelling; a function of a package is called by its full name",
            Code::BadCall => {
                "compare the call with the function's inputs: their order, types and numbers of dimensions count"
            }
            Code::Unsupported => "write it with other means of the language",
            Code::BadConnect => "`connect` joins ports of components; values are related by equations",
            Code::TypeMismatch => {
                "values are converted by hand: `integer(x)` makes an Integer of a Real, `if b then 1 else 0` a number \
                 of a Boolean, `String(x)` a text"
            }
            Code::SizeMismatch => {
                "make the sizes equal: `fill(v, n)` repeats a value, `x[1:2]` takes a part, `transpose` turns a matrix; \
                 `.+` and `.*` work element by element"
            }
            Code::NotConstant => "use parameters and constants here; what changes during the run belongs in equations",
            Code::BadIndex => "indices count from 1 to the size of the array; `end` is the last one",
            Code::OutOfRange => "give a value within the bounds",
            Code::Evaluation => "check the values that it is computed from",
            Code::Recursion => "a recursive function must reach a case in which it does not call itself",
            Code::TooLarge => "check the numbers that give the sizes",
            Code::AssertionFailed | Code::AssertionWarning => {
                "this is a limit that the model sets: look at the values that lead there"
            }
            _ => return None,
        })
    }
}
