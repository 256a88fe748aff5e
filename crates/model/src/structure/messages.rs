//! Diagnostics of the analysis: what it says when a model cannot be solved.
//!
//! Each function makes one kind of diagnostic. They name whole groups of variables and equations as the user wrote
//! them, and give the physical reason where a known pattern shows it, such as a circuit without ground. The other files
//! of `structure` call them; none of them decides whether something is wrong. Lists are cut after [`MOST_ITEMS`].

use super::draft::{DaeDraft, SystemRole};
use super::dulmage_mendelsohn::DecompositionPart;
use super::parameters::SignAnalysis;
use super::places;
use super::regularity::StructuralSingularity;
use super::starts;
use super::{Alias, Unknown};
use crate::flat::{ElementOrigin, FlatEquation, OriginKind};
use bramah_expr::{ExprId, VarId};
use bramah_syntax::diag::{Code, Diagnostic, Severity};

/// The most names, equations or places that a message lists.
const MOST_ITEMS: usize = 10;

/// Parameters whose bindings use each other (E214). `circle` has at least one member.
///
/// Each member gets a place with its binding, so that the reader can follow the circle.
pub(super) fn cyclic_parameters(draft: &DaeDraft, circle: &[VarId]) -> Diagnostic {
    let names: Vec<String> = circle.iter().map(|&v| name(draft, v)).collect();
    let message = match names.as_slice() {
        [one] => format!("parameter {one} depends on itself"),
        _ => format!("parameters depend on each other cyclically: {}", listed(&names)),
    };
    let mut made = Diagnostic::new(Code::CyclicParameter, message);
    for &v in circle.iter().take(MOST_ITEMS) {
        let variable = &draft.variables[v.index()];
        let text = variable.binding.map(|e| format!("`{}` = `{}`", variable.name, draft.text(e))).unwrap_or_default();
        made = made.at(variable.origin.span, text);
    }
    made.help("give one of them a value that does not use the others")
}

/// Two names of one quantity with different starts. It is an error (E401) if both are fixed or none is. If one is
/// fixed, the other yields, and it is a warning (W404).
///
/// Both places show the value, the parameter that gives it, and whether it is fixed. The help frees the start that is
/// nearer to the user's model.
pub(super) fn contradicting_aliases(draft: &DaeDraft, known: &mut SignAnalysis, alias: Alias) -> Diagnostic {
    let mut value = |v: VarId| {
        let start = draft.variables[v.index()].start;
        start.map_or(Some(0.0), |e| known.value(&draft.exprs, e)).map_or("?".to_owned(), |x| format!("{x}"))
    };
    let (a, b) = (alias.target, alias.variable);
    let sign = if alias.negated { "-" } else { "" };
    let message = format!("{} and {sign}{} are equal but start at different values", name(draft, a), name(draft, b));
    let mut said = |v: VarId| {
        let behind = starts::parameter_behind(&draft.exprs, &draft.variables, v);
        let behind = behind.map_or(String::new(), |p| format!(" by `{p}`"));
        let fixed = if draft.variables[v.index()].fixed { ", fixed" } else { "" };
        format!("{} starts at {}{behind}{fixed}", name(draft, v), value(v))
    };
    let (at_a, at_b) = (said(a), said(b));
    let (of_a, of_b) = (&draft.variables[a.index()], &draft.variables[b.index()]);
    let mut made = if of_a.fixed == of_b.fixed {
        Diagnostic::new(Code::InitialOver, message)
    } else {
        let fixed = if of_b.fixed { b } else { a };
        Diagnostic::new(Code::StartMissed, format!("{message}: that of {}, which is fixed, counts", name(draft, fixed)))
    };
    for (v, text) in [(a, at_a), (b, at_b)] {
        made = made.at(places::own_place(draft, v), text);
    }
    if !made.is_error() {
        return made.help("give both the same value, or `fixed = true` to the one that must hold");
    }
    // The start with fewer dots is the user's own, or nearer to it, and is the one to be freed.
    let depth = |v: VarId| draft.variables[v.index()].name.matches('.').count();
    let freed = starts::modifier(&draft.variables[if depth(a) <= depth(b) { a } else { b }.index()].name, false);
    let freed = freed.map_or(String::new(), |m| format!(", as by `{m}`"));
    made.help(format!("fix the start of one of them only{freed}, or give both the same value"))
}

/// A constraint that would have to be differentiated but cannot be (E304). `v` is the variable without the derivative.
///
/// The help for an input is a filter or a second input; for any other variable it is to write the constraint without
/// the derivative.
pub(super) fn not_differentiable(draft: &DaeDraft, equation: &FlatEquation, v: VarId) -> Diagnostic {
    let input = draft.role(v) == SystemRole::Input;
    // The two cases need different advice: an input can be filtered, a constraint must be rewritten.
    let message = if input {
        format!("the derivative of the input {} is needed, but inputs have none", name(draft, v))
    } else {
        format!("a derivative of {} of too high an order is needed", name(draft, v))
    };
    // Either the equation contains the derivative itself, or index reduction asked for it.
    let direct = [equation.lhs, equation.rhs].iter().any(|&e| draft.exprs.derivatives(e).contains(&v));
    let text = if direct {
        "it is used here".to_owned()
    } else {
        format!("`{}` fixes a quantity whose derivative is used elsewhere", sides(draft, equation))
    };
    let made = Diagnostic::new(Code::IndexReduction, message).at(equation.origin.span, text);
    located(draft, made, equation).help(if input {
        "pass the input through a filter (a first-order lag), or give its derivative as an input of its own"
    } else {
        "write the constraint without the derivative"
    })
}

/// A constraint whose unknowns cancel when it is differentiated: another equation says the same, or contradicts it
/// (E301).
/// An example is `der(x) - der(x) = u`.
pub(super) fn cancelling(draft: &DaeDraft, equation: &FlatEquation) -> Diagnostic {
    let message = format!("the equation `{}` determines nothing", sides(draft, equation));
    let made = Diagnostic::new(Code::Singular, message)
        .at(equation.origin.span, "its unknowns cancel")
        .help("look for a term that stands on both sides, or write the equation that was meant");
    located(draft, made, equation)
}

/// Equations whose unknowns cancel when they are added up, while `left` remains, which would have to be 0 (E303).
///
/// The usual cause are two ideal sources that act on one quantity.
pub(super) fn contradiction(draft: &DaeDraft, equations: &[FlatEquation], left: ExprId) -> Diagnostic {
    let message =
        format!("{} equations contradict each other: together they say `0 = {}`", equations.len(), draft.text(left));
    with_equations(draft, Diagnostic::new(Code::Overdetermined, message), equations).help(
        "two ideal sources cannot act on the same quantity: put a resistance or a storage between them, or remove one",
    )
}

/// Equations of which one follows from the others. `free` lists unknowns that can therefore change together, each with
/// its part in a common change.
///
/// If the parts are equal and the unknowns are potentials, the note speaks of a common level, as for a circuit without
/// ground. Otherwise it lists the parts: the unknowns share a load in no unique way.
pub(super) fn repeated(draft: &DaeDraft, equations: &[FlatEquation], free: &[(VarId, f64)]) -> Diagnostic {
    let message = format!("each of {} equations follows from the others", equations.len());
    let unknowns: Vec<VarId> = free.iter().map(|(v, _)| *v).collect();
    let names: Vec<String> = unknowns.iter().map(|&v| name(draft, v)).collect();
    // Equal parts of potentials mean that a common level is free; other parts are listed as they are.
    let together = free.iter().all(|(_, part)| (part - free[0].1).abs() < 1e-9);
    let flow = unknowns.iter().any(|v| draft.variables[v.index()].flow);
    let made = Diagnostic::new(Code::Singular, message);
    let made = with_equations(draft, made, equations);
    match names.as_slice() {
        [] => made.help("replace one of them by one that says something new"),
        [one] => made.note(format!("nothing determines {one}")),
        _ if together && !flow => {
            let (level, advice) = kind_of_level(draft, &unknowns);
            made.note(format!("nothing determines the common {level} of {}", listed(&names))).help(advice)
        }
        _ => {
            let part = |&(v, part): &(VarId, f64)| {
                format!("{} by {}", name(draft, v), bramah_expr::print::number(part, Some(4)))
            };
            let parts: Vec<String> = free.iter().map(part).collect();
            made.note(format!("all equations still hold if these change together: {}", listed(&parts)))
                .help("add a resistance, a storage or a reference that determines how they share, or remove one of the components")
        }
    }
}

/// `reinit` of a variable that follows from other quantities. `origin` is the place of the `reinit`.
/// The code is E305.
pub(super) fn reinit_of_no_state(draft: &DaeDraft, v: VarId, origin: ElementOrigin) -> Diagnostic {
    let message = format!("{} cannot be set by `reinit`, because it follows from other quantities", name(draft, v));
    let instance = &draft.instances[origin.instance as usize];
    Diagnostic::new(Code::ReinitNoState, message)
        .at(origin.span, "only a state can jump")
        .instance(instance.name.clone())
        .class(instance.class.clone())
        .help("set the state it follows from; a variable is a state if its derivative is used and nothing ties it to others")
}

/// A position that a constraint of parameters alone fixes, though the circuit computes an acceleration for it. `bodies`
/// are the names of the position.
/// The code is N306, a note.
pub(super) fn held_still(draft: &DaeDraft, bodies: &[VarId], equation: &FlatEquation) -> Diagnostic {
    let names: Vec<String> = bodies.iter().map(|&v| name(draft, v)).collect();
    let mut made = Diagnostic::new(Code::HeldStill, format!("{} cannot change", listed(&names)));
    if let Some(&first) = bodies.first() {
        made = made.at(places::own_place(draft, first), "what moves with it stays at rest");
    }
    let holder = &draft.instances[equation.origin.instance as usize];
    let by = if holder.name.is_empty() { String::new() } else { format!(" of `{}`", holder.name) };
    made.note(format!("the equation `{}`{by} fixes it", sides(draft, equation)))
        .help("if it should move, put a spring, a cylinder or an actuator between it and what holds it")
}

/// Constraints that no choice of states satisfies. `unknowns` are those that no equation is left for.
/// The code is E303.
pub(super) fn dependent_constraints(draft: &DaeDraft, equations: &[FlatEquation], unknowns: &[Unknown]) -> Diagnostic {
    let made = Diagnostic::new(Code::Overdetermined, "constraints and their derivatives depend on each other");
    let made = with_equations(draft, made, equations);
    let names: Vec<String> = unknowns.iter().map(|&u| unknown_name(draft, u)).collect();
    if names.is_empty() { made } else { made.note(format!("nothing is left to determine {}", listed(&names))) }
}

/// Initial equations and fixed starts that say too much (E401). `extra` is the condition that found no unknown, `group`
/// all equations that compete with it.
///
/// The note counts how many conditions there are and how many can hold: one less than there are.
pub(super) fn initially_contradicting(draft: &DaeDraft, extra: &FlatEquation, group: &[FlatEquation]) -> Diagnostic {
    // The equations of the model are no choice of the user here, so only conditions are counted and listed.
    let conditions: Vec<FlatEquation> = group.iter().filter(|e| is_condition(draft, e)).copied().collect();
    let message = if extra.origin.kind == OriginKind::Start {
        format!("the fixed start of `{}` is one condition too many", draft.text(extra.lhs))
    } else {
        format!("the initial equation `{}` is one condition too many", sides(draft, extra))
    };
    let made = Diagnostic::new(Code::InitialOver, message);
    let others: Vec<FlatEquation> = conditions.iter().filter(|e| *e != extra).copied().collect();
    let made = with_equations(draft, made.at(extra.origin.span, "this one is too much"), &others);
    // One condition less than there are would have found unknowns.
    let (have, want) = (counted(conditions.len(), "condition"), conditions.len().max(1) - 1);
    let note = match want {
        0 => format!("there is {have} where none can hold"),
        _ => format!("there are {have} where {want} can hold"),
    };
    made.note(note).help("remove one of these conditions, for instance by `fixed = false`")
}

/// Whether an equation holds at the start only.
fn is_condition(draft: &DaeDraft, equation: &FlatEquation) -> bool {
    let initial = &draft.initial_equations;
    equation.origin.kind == OriginKind::Start || initial.iter().any(|e| e.origin == equation.origin)
}

/// Unknowns that no equation and no start value determines at the start.
/// The code is E403.
pub(super) fn initially_undetermined(draft: &DaeDraft, open: &[Unknown]) -> Diagnostic {
    let names: Vec<String> = open.iter().map(|&u| unknown_name(draft, u)).collect();
    let made = Diagnostic::new(Code::InitialFailed, format!("nothing determines {} at the start", listed(&names)));
    made.help("add an initial equation or a fixed start value")
}

/// A note about start values that the compiler fixed to make the start determined.
///
/// The code is W402, but the severity is lowered to a note.
pub(super) fn chosen_starts(draft: &DaeDraft, chosen: &[VarId]) -> Diagnostic {
    let names: Vec<String> = chosen.iter().map(|&v| name(draft, v)).collect();
    let text = format!("start values used although not `fixed`: {}", listed(&names));
    let mut made = Diagnostic::new(Code::InitialUnder, text);
    // Many good models rely on this, so it is no warning.
    made.severity = Severity::Note;
    if let Some(&first) = chosen.first() {
        made = made.at(draft.variables[first.index()].origin.span, "");
    }
    made
}

/// A group of nodes that exchanges nothing with a reference, so that only differences of potentials matter. `flows` are
/// the flows of its sums, ascending.
///
/// The code is E302 where the flows belong to connectors: the message then lists the components and the potentials of
/// their ports. For sums written by hand it is E301.
pub(super) fn closed_group(draft: &DaeDraft, aliases: &[Alias], flows: &[VarId]) -> Diagnostic {
    let mut names: Vec<VarId> = flows.to_vec();
    // Ports may carry the eliminated names of the flows.
    names.extend(aliases.iter().filter(|a| flows.binary_search(&a.target).is_ok()).map(|a| a.variable));
    let variable = |v: &VarId| &draft.variables[v.index()];
    let mut ports: Vec<u32> = names.iter().map(variable).filter(|v| v.flow).map(|v| v.origin.instance).collect();
    ports.sort_unstable();
    ports.dedup();
    let levels: Vec<VarId> = (0..draft.variables.len() as u32)
        .map(VarId)
        .filter(|v| !variable(v).flow && ports.binary_search(&variable(v).origin.instance).is_ok())
        .collect();
    let mut owners: Vec<u32> = ports.iter().map(|&p| draft.instances[p as usize].parent).collect();
    owners.sort_unstable();
    owners.dedup();
    let components: Vec<String> = owners.iter().map(|&i| draft.instances[i as usize].name.clone()).collect();
    // The flows belong to no connector: the equations were written by hand.
    if levels.is_empty() {
        let names: Vec<String> = flows.iter().map(|&v| name(draft, v)).collect();
        let message = format!("the sums that hold {} follow from each other", listed(&names));
        return Diagnostic::new(Code::Singular, message)
            .at(variable(&flows[0]).origin.span, "every term stands in two sums with opposite signs")
            .help("replace one of these equations by one that says something new");
    }
    let (level, advice) = kind_of_level(draft, &levels);
    let message = format!("nothing fixes the {level} of {{{}}}", listed(&components));
    let mut made = Diagnostic::new(Code::NoReference, message);
    // One place for each component, even if it has several ports in the group.
    let mut reported: Vec<u32> = Vec::new();
    for v in &levels {
        let owner = draft.instances[variable(v).origin.instance as usize].parent;
        if !reported.contains(&owner) && reported.len() < MOST_ITEMS {
            let text = format!("only differences of `{}` to others matter", variable(v).name);
            made = made.at(places::own_place(draft, *v), text);
            reported.push(owner);
        }
    }
    made.note(
        "these components pass on all that flows in, so the sum of flows at one node follows from the other nodes",
    )
    .help(advice)
}

/// A structurally singular system (E301, E302, E303). `aliases` are those eliminated from this system already; an empty
/// list means that it is as the user wrote it.
///
/// The headline names a pattern that an engineer knows; the notes list both parts of the decomposition.
pub(super) fn singular(draft: &DaeDraft, aliases: &[Alias], found: &StructuralSingularity) -> Diagnostic {
    let report = SingularityReport { draft, aliases, found };
    let made = report.headline();
    report.with_facts(made)
}

/// Makes the message about a structurally singular system.
struct SingularityReport<'a> {
    /// The system.
    draft: &'a DaeDraft,
    /// The aliases eliminated from it.
    aliases: &'a [Alias],
    /// Its matching and decomposition.
    found: &'a StructuralSingularity,
}

impl SingularityReport<'_> {
    /// The underdetermined part.
    fn under(&self) -> &DecompositionPart {
        &self.found.parts.under
    }

    /// The overdetermined part.
    fn over(&self) -> &DecompositionPart {
        &self.found.parts.over
    }

    /// The unknowns of a part.
    fn variables(&self, part: &DecompositionPart) -> Vec<VarId> {
        part.columns.iter().map(|&c| self.found.overview.columns[c as usize]).collect()
    }

    /// The equations of a part.
    fn equations(&self, part: &DecompositionPart) -> Vec<FlatEquation> {
        part.rows.iter().map(|&r| self.draft.equations[r as usize]).collect()
    }

    /// The message with its main places: a recognised pattern, or the sizes of the parts.
    ///
    /// Patterns are tried from the most to the least specific: an equation of known quantities only, a group without a
    /// reference, a potential that is determined twice.
    ///
    /// An equation without unknowns that still contains parameters or inputs is the most specific fault. Potentials
    /// alone in the underdetermined part mean a missing reference.
    fn headline(&self) -> Diagnostic {
        let unknowns = self.variables(self.under());
        let empty: Vec<FlatEquation> =
            self.equations(self.over()).into_iter().filter(|e| self.holds_nothing(e)).collect();
        let all_known = empty.iter().find(|e| !self.draft.exprs.dependencies(&[e.lhs, e.rhs]).vars.is_empty());
        if let Some(equation) = all_known {
            return self.without_unknowns(equation);
        }
        let levels: Vec<VarId> = unknowns.iter().copied().filter(|&v| self.is_potential(v)).collect();
        // A sum of flows without unknowns follows from the other sums: the group exchanges nothing with a reference.
        let closed = empty.iter().any(|e| e.origin.kind == OriginKind::ConnectFlow);
        if !levels.is_empty() && (closed || levels.len() == unknowns.len()) {
            return self.no_reference(&levels);
        }
        let twice = self.variables(self.over());
        let flow = |v: &VarId| self.draft.variables[v.index()].flow;
        if twice.len() == 1 || twice.iter().any(|&v| self.is_potential(v)) && !twice.iter().any(flow) {
            return self.determined_twice(&twice);
        }
        match empty.first() {
            Some(equation) => self.without_unknowns(equation),
            None => self.general(&unknowns),
        }
    }

    /// The message where no pattern fits: unknowns that no equation mentions, or the counts of equations and unknowns.
    /// The code is E301 for too few equations and E303 for too many.
    fn general(&self, unknowns: &[VarId]) -> Diagnostic {
        // An unknown that no equation mentions is the simplest cause, so it is reported first.
        let unused: Vec<VarId> = unknowns.iter().copied().filter(|&v| self.is_unused(v)).collect();
        if !unused.is_empty() {
            let names: Vec<String> = unused.iter().map(|&v| name(self.draft, v)).collect();
            let message = format!("no equation mentions {}", listed(&names));
            return self
                .labelled(Diagnostic::new(Code::Singular, message), &unused)
                .help("add an equation, give it a value, or make it a top-level `input`");
        }
        if unknowns.is_empty() {
            let DecompositionPart { rows, columns } = self.over();
            let message = format!("{} equations for {} unknowns", rows.len(), columns.len());
            let made = Diagnostic::new(Code::Overdetermined, message);
            return with_equations(self.draft, made, &self.equations(self.over()));
        }
        let names: Vec<String> = unknowns.iter().map(|&v| name(self.draft, v)).collect();
        let (rows, count) = (self.under().rows.len(), unknowns.len());
        let message = format!("{rows} equations cannot determine {count} unknowns: {}", listed(&names));
        self.labelled(Diagnostic::new(Code::Singular, message), unknowns)
    }

    /// The message about an equation of parameters, inputs and numbers only.
    /// The code is E303.
    fn without_unknowns(&self, equation: &FlatEquation) -> Diagnostic {
        let used = self.draft.exprs.dependencies(&[equation.lhs, equation.rhs]).vars;
        let names: Vec<String> = used.iter().map(|&v| name(self.draft, v)).collect();
        let message = format!("the equation `{}` holds no unknown", sides(self.draft, equation));
        let mut made = located(self.draft, Diagnostic::new(Code::Overdetermined, message), equation);
        made = made.at(equation.origin.span, "everything in it is known already");
        // Nothing is left in the equation: its sides became equal when aliases were eliminated.
        if names.is_empty() {
            return made.note("its sides cancel, so another equation says the same already");
        }
        made.note(format!("known before the run: {}", listed(&names)))
            .help("if one of them is meant to be found by this equation, declare it without `parameter` or `input`")
    }

    /// The message where only levels (potentials) of connected nodes are undetermined.
    /// The code is E302, and the help depends on the domain: see [`kind_of_level`].
    fn no_reference(&self, unknowns: &[VarId]) -> Diagnostic {
        let (level, advice) = kind_of_level(self.draft, unknowns);
        let components = self.components_of(unknowns);
        let message = format!("nothing fixes the {level} of {{{}}}", cut(&components, ", "));
        let made = Diagnostic::new(Code::NoReference, message).help(advice);
        self.labelled(made, unknowns)
    }

    /// The message where more equations than needed determine a few quantities.
    ///
    /// If two components are involved, the help says that two ideal sources cannot act on one quantity. If one is
    /// involved and some unknowns are left over, it suggests that one of the equations was meant for them.
    fn determined_twice(&self, twice: &[VarId]) -> Diagnostic {
        let equations = self.equations(self.over());
        let mut owners: Vec<String> = equations.iter().map(|e| self.owner(e)).filter(|o| !o.is_empty()).collect();
        // Two different components suggest two ideal sources; one component suggests a mistake in its equations.
        owners.dedup();
        let levels: Vec<VarId> = twice.iter().copied().filter(|&v| self.is_potential(v)).collect();
        let message = match (owners.as_slice(), levels.is_empty()) {
            ([a, b], _) => format!("{} is determined by both `{a}` and `{b}`", name(self.draft, twice[0])),
            (_, true) => format!("{} is determined more than once", name(self.draft, twice[0])),
            (_, false) => {
                let components = cut(&self.components_of(&levels), ", ");
                let level = kind_of_level(self.draft, &levels).0;
                format!("the {level} of {{{components}}} is determined once too often")
            }
        };
        let made = with_equations(self.draft, Diagnostic::new(Code::Overdetermined, message), &equations);
        let left: Vec<String> = self.variables(self.under()).iter().map(|&v| name(self.draft, v)).collect();
        if owners.len() < 2 && !left.is_empty() {
            return made
                .help(format!("one of these equations is meant to determine {}, or is too much", listed(&left)));
        }
        if owners.len() < 2 {
            return made.help("remove one of these equations");
        }
        made.help("two ideal sources cannot act on the same quantity: put a resistance or a storage between them, or remove one")
    }

    /// Adds the counts and the members of both parts, so that the reader can check the headline.
    fn with_facts(&self, made: Diagnostic) -> Diagnostic {
        let overview = &self.found.overview;
        let pairs = overview.matching.column_of.iter().filter(|&&c| c != super::incidence::NONE).count();
        let rows = overview.incidence.rows();
        let made = made
            .note(format!("{rows} equations and {} unknowns, but only {pairs} pairs match", overview.columns.len()));
        let made = self.part_note(made, "too few equations for", self.under());
        self.part_note(made, "too many equations for", self.over())
    }

    /// Adds the unknowns of a part, one line for each component.
    /// A component is the first part of a name. At most [`MOST_ITEMS`] components are listed.
    fn part_note(&self, made: Diagnostic, title: &str, part: &DecompositionPart) -> Diagnostic {
        if part.columns.is_empty() {
            return made;
        }
        let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
        for v in self.variables(part) {
            let name = &self.draft.variables[v.index()].name;
            let (component, rest) = name.split_once('.').unwrap_or(("", name));
            match groups.iter_mut().find(|g| g.0 == component) {
                Some(group) => group.1.push(rest.to_owned()),
                None => groups.push((component, vec![rest.to_owned()])),
            }
        }
        let line = |(component, names): &(&str, Vec<String>)| match *component {
            "" => format!("  {}", listed(names)),
            component => format!("  {component}: {}", listed(names)),
        };
        let mut lines: Vec<String> = groups.iter().take(MOST_ITEMS).map(line).collect();
        if groups.len() > MOST_ITEMS {
            lines.push(format!("  and {} more components", groups.len() - MOST_ITEMS));
        }
        let (rows, columns) = (counted(part.rows.len(), "equation"), counted(part.columns.len(), "unknown"));
        made.note(format!("{title} these unknowns ({rows}, {columns}):\n{}", lines.join("\n")))
    }

    /// Adds the places where the unknowns are declared, and the instance of the first one.
    /// At most [`MOST_ITEMS`] places are shown.
    fn labelled(&self, mut made: Diagnostic, unknowns: &[VarId]) -> Diagnostic {
        for &v in unknowns.iter().take(MOST_ITEMS) {
            let variable = &self.draft.variables[v.index()];
            made = made.at(places::own_place(self.draft, v), format!("`{}` is undetermined", variable.name));
        }
        match unknowns.first() {
            Some(&v) => {
                let instance = &self.draft.instances[self.draft.variables[v.index()].origin.instance as usize];
                made.instance(instance.name.clone()).class(instance.class.clone())
            }
            None => made,
        }
    }

    /// The name of the instance that an equation belongs to; empty for the model itself.
    fn owner(&self, equation: &FlatEquation) -> String {
        self.draft.instances[equation.origin.instance as usize].name.clone()
    }

    /// Whether an equation contains no unknown.
    fn holds_nothing(&self, equation: &FlatEquation) -> bool {
        let found = self.draft.exprs.dependencies(&[equation.lhs, equation.rhs]);
        let unknown = |v: &VarId| matches!(self.draft.role(*v), SystemRole::Continuous | SystemRole::Discrete);
        !found.vars.iter().chain(&found.ders).any(unknown)
    }

    /// Whether no equation can be solved for a variable or its derivatives.
    /// Linear in the number of equations, which is enough for a message.
    fn is_unused(&self, v: VarId) -> bool {
        let overview = &self.found.overview;
        let column = overview.columns.iter().position(|&c| c == v).map(|c| c as u32);
        column.is_some_and(|c| {
            (0..overview.incidence.rows() as u32).all(|r| !overview.incidence.solvable(r).contains(&c))
        })
    }

    /// All names of a quantity: the variable and its aliases.
    fn names_of(&self, v: VarId) -> impl Iterator<Item = VarId> {
        let others = self.aliases.iter().filter(move |a| a.target == v).map(|a| a.variable);
        std::iter::once(v).chain(others)
    }

    /// Whether a variable is the potential of a connector, or equal to one.
    /// Every variable of a connector that is no flow counts.
    fn is_potential(&self, v: VarId) -> bool {
        self.names_of(v).any(|v| {
            let variable = &self.draft.variables[v.index()];
            !variable.flow && places::is_connector(&self.draft.variables, variable.origin.instance)
        })
    }

    /// The names of the components whose connectors carry these potentials, in the order of instances.
    fn components_of(&self, unknowns: &[VarId]) -> Vec<String> {
        let mut found: Vec<u32> = Vec::new();
        for v in unknowns.iter().flat_map(|&v| self.names_of(v)) {
            let instance = self.draft.variables[v.index()].origin.instance;
            if places::is_connector(&self.draft.variables, instance) {
                found.push(self.draft.instances[instance as usize].parent);
            }
        }
        found.sort_unstable();
        found.dedup();
        found.iter().map(|&i| self.draft.instances[i as usize].name.clone()).filter(|n| !n.is_empty()).collect()
    }
}

/// What potentials with this unit are called, and advice on what fixes them. The first unit among the unknowns decides.
///
/// The unit decides about the domain: Pa is hydraulic, V electric, K thermal, rad rotational, m translational.
fn kind_of_level(draft: &DaeDraft, unknowns: &[VarId]) -> (&'static str, &'static str) {
    let unit = unknowns.iter().find_map(|v| draft.variables[v.index()].unit.as_deref());
    match unit {
        Some("Pa" | "bar") => ("pressure level", "connect a tank, a volume or a fixed pressure to one of these nodes"),
        Some("V") => ("potential", "connect a ground to one of these nodes"),
        Some("K" | "degC") => ("temperature", "connect a heat capacity or a fixed temperature to one of these nodes"),
        Some("rad" | "deg") => ("angle", "put an inertia, a spring or a fixed support at one of these flanges"),
        Some("m") => ("position", "put a mass, a spring or a fixed support at one of these flanges"),
        _ => ("level", "connect a source, a storage or a fixed reference to one of these nodes"),
    }
}

/// Adds the places of equations, each with its text and why it exists.
/// At most [`MOST_ITEMS`] equations are shown; a note counts the others.
fn with_equations(draft: &DaeDraft, mut made: Diagnostic, equations: &[FlatEquation]) -> Diagnostic {
    for equation in equations.iter().take(MOST_ITEMS) {
        made = made.at(equation.origin.span, format!("`{}`{}", sides(draft, equation), reason(equation.origin.kind)));
    }
    if equations.len() > MOST_ITEMS {
        made = made.note(format!("and {} more equations", equations.len() - MOST_ITEMS));
    }
    match equations.first() {
        Some(first) => located(draft, made, first),
        None => made,
    }
}

/// Adds the instance of an equation and its class.
fn located(draft: &DaeDraft, made: Diagnostic, equation: &FlatEquation) -> Diagnostic {
    let instance = &draft.instances[equation.origin.instance as usize];
    made.instance(instance.name.clone()).class(instance.class.clone())
}

/// Why the compiler made an equation, as the end of a label; empty for equations of the user.
fn reason(kind: OriginKind) -> &'static str {
    match kind {
        OriginKind::ConnectPotential => ", from a connection",
        OriginKind::ConnectFlow => ", the sum of flows at a node",
        OriginKind::OpenPort => ", because the port is open",
        OriginKind::Differentiated => ", the derivative of this equation",
        OriginKind::Start => ", a fixed start",
        OriginKind::Guess => ", a start that is a guess",
        _ => "",
    }
}

/// The text of an equation.
fn sides(draft: &DaeDraft, equation: &FlatEquation) -> String {
    let side = |e: ExprId| draft.text(e);
    format!("{} = {}", side(equation.lhs), side(equation.rhs))
}

/// The name of a variable in backticks.
fn name(draft: &DaeDraft, v: VarId) -> String {
    format!("`{}`", draft.variables[v.index()].name)
}

/// The name of an unknown in backticks.
fn unknown_name(draft: &DaeDraft, unknown: Unknown) -> String {
    match unknown {
        Unknown::Var(v) => name(draft, v),
        Unknown::Der(v) => format!("`der({})`", draft.variables[v.index()].name),
    }
}

/// A number with its noun, which takes an `s` except after 1.
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Names joined by commas, cut after [`MOST_ITEMS`].
fn listed(names: &[String]) -> String {
    cut(names, ", ")
}

/// Names joined by a separator, cut after [`MOST_ITEMS`].
fn cut(names: &[String], separator: &str) -> String {
    let shown = names[..names.len().min(MOST_ITEMS)].join(separator);
    if names.len() > MOST_ITEMS { format!("{shown} and {} more", names.len() - MOST_ITEMS) } else { shown }
}
