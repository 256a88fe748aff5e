//! Alias elimination: variables that equal another one or its negative, and variables that are the derivative of
//! another one.
//!
//! Enters: the draft with its equations. Leaves: the draft rewritten in one representative of each alias set, with
//! merged attributes, and the list of [`Alias`]es. `analysis` calls [`eliminate`] before anything is matched.
//!
//! The alias sets are a union-find structure with signs. An equation `w = der(phi)` links `phi` to `w`; if `phi` equals
//! `psi`, their derivatives are equal too. The links keep index reduction from making a second variable `der(phi)`
//! beside `w`.

use super::draft::{DaeDraft, SignedVariable, SystemRole};
use super::{Alias, EventActionKind, messages, parameters};
use crate::flat::{ElementOrigin, FlatEquation, OriginKind, ScalarType, StateSelect};
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction, VarId};
use bramah_syntax::diag::Diagnostic;

/// Removes alias equations and rewrites every expression in terms of the representatives. Contradicting start values go
/// to `diagnostics`. The aliases come out in ascending order of the eliminated variable.
///
/// Equations that define aliases are removed. Equations that repeat an alias become `0 = 0`. Aliases of given values
/// (inputs) keep the input as their representative.
pub(super) fn eliminate(
    draft: &mut DaeDraft,
    known: &mut parameters::SignAnalysis,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<Alias> {
    let mut classes = AliasClasses::new(draft);
    let mut links = Vec::new();
    let mut found = Vec::new();
    let mut kept = vec![true; draft.equations.len()];
    for (i, equation) in draft.equations.iter().enumerate() {
        match simple_form(&draft.exprs, equation) {
            Some(AliasEquation::Equal(a, b)) if may_join(draft, a.variable, b) => {
                kept[i] = !classes.join(draft, a.variable, b)
            }
            // A free parameter is no unknown of the run and cannot be an alias of one; only its guess is shared.
            Some(AliasEquation::Equal(a, b)) if is_found(draft, a.variable) => found.push((a, b)),
            Some(AliasEquation::Equal(a, b)) if is_found(draft, b.variable) => found.push((b, a)),
            Some(AliasEquation::Derivative(w, of)) => links.push((i, w, of)),
            _ => {}
        }
    }
    // After all joins: a link between two sets of aliases needs the final representatives on both sides.
    link_derivatives(draft, &mut classes, &links, &mut kept);
    retain(draft, &kept);
    let differentiated = links.iter().map(|(.., of)| of.variable);
    let targets = classes.settle(draft, differentiated);
    let aliases = aliases(&targets);
    for alias in &aliases {
        merge(draft, known, *alias, diagnostics);
        draft.roles[alias.variable.index()] = SystemRole::Alias;
    }
    for (parameter, variable) in found {
        let target = targets[variable.variable.index()];
        let negated = parameter.negated != (variable.negated != target.negated);
        share_guess(draft, parameter.variable, SignedVariable { variable: target.variable, negated });
    }
    rewrite(draft, &targets);
    // Redundant aliases (a ring of connections) become `0 = 0`. The equation stays, so that the regularity check
    // reports that it determines no unknown.
    for equation in draft.equations.iter_mut().filter(|e| e.lhs == e.rhs) {
        (equation.lhs, equation.rhs) = (Exprs::ZERO, Exprs::ZERO);
    }
    aliases
}

/// What an equation with one or two leaves says.
pub(super) enum AliasEquation {
    /// The variable is 0.
    Zero(VarId),
    /// The first equals the second.
    Equal(SignedVariable, SignedVariable),
    /// The first is the derivative of the second.
    Derivative(SignedVariable, SignedVariable),
}

/// Reads an equation as an alias equation. `None` where it has more than two terms, factors other than plus or minus
/// one, or leaves that are neither variables nor derivatives.
/// Examples: `a = b`, `a + b = 0`, `-a = b`, `w = der(x)`, `0 = -a`.
pub(super) fn simple_form(pool: &Exprs, equation: &FlatEquation) -> Option<AliasEquation> {
    let mut terms = AliasTerms::default();
    terms.collect(pool, equation.lhs, false, 0)?;
    terms.collect(pool, equation.rhs, true, 0)?;
    let ((a, first), (b, second)) = match terms.found.as_slice() {
        [first, second] => (first, second),
        [(only, _)] => {
            return if let ExprNode::Var(v) = pool.node(*only) { Some(AliasEquation::Zero(v)) } else { None };
        }
        _ => return None,
    };
    // `first*a + second*b = 0`
    // `first*a + second*b = 0`: equal signs mean `a = -b`.
    let negated = first == second;
    match (pool.node(*a), pool.node(*b)) {
        (ExprNode::Var(a), ExprNode::Var(b)) if a != b => Some(AliasEquation::Equal(
            SignedVariable { variable: a, negated: false },
            SignedVariable { variable: b, negated },
        )),
        (ExprNode::Var(w), ExprNode::Der(x)) | (ExprNode::Der(x), ExprNode::Var(w)) => Some(AliasEquation::Derivative(
            SignedVariable { variable: w, negated: false },
            SignedVariable { variable: x, negated },
        )),
        _ => None,
    }
}

/// The terms of `lhs - rhs`: at most two leaves, each with its sign.
#[derive(Default)]
struct AliasTerms {
    /// The leaf, and `true` for a minus sign.
    found: Vec<(ExprId, bool)>,
}

impl AliasTerms {
    /// Adds the terms of an expression. `None` where it is no sum of at most two leaves.
    fn collect(&mut self, pool: &Exprs, e: ExprId, negated: bool, depth: u32) -> Option<()> {
        if e == Exprs::ZERO {
            return Some(());
        }
        match pool.node(e) {
            // A limit for the recursion: an expression nested deeper is left as it is.
            _ if depth > 4 => None,
            ExprNode::Var(_) | ExprNode::Der(_) if self.found.len() < 2 => {
                self.found.push((e, negated));
                Some(())
            }
            ExprNode::Unary(UnaryFunction::Neg, a) => self.collect(pool, a, !negated, depth + 1),
            ExprNode::Binary(op @ (BinaryFunction::Add | BinaryFunction::Sub), a, b) => {
                self.collect(pool, a, negated, depth + 1)?;
                self.collect(pool, b, negated != (op == BinaryFunction::Sub), depth + 1)
            }
            _ => None,
        }
    }
}

/// Whether two variables may be aliases: both continuous, or both discrete, of one type and with the same sign.
/// Booleans and other discrete types have no negative that could be an alias.
fn may_join(draft: &DaeDraft, a: VarId, b: SignedVariable) -> bool {
    let continuous = |v: VarId| {
        let real = draft.variables[v.index()].ty == ScalarType::Real;
        draft.role(v) == SystemRole::Continuous || draft.role(v) == SystemRole::Input && real
    };
    if continuous(a) && continuous(b.variable) {
        return true;
    }
    let discrete = |v: VarId| {
        let given = draft.variables[v.index()].ty != ScalarType::Real && draft.role(v) == SystemRole::Input;
        given || matches!(draft.role(v), SystemRole::Discrete | SystemRole::Sample)
    };
    let same = draft.variables[a.index()].ty == draft.variables[b.variable.index()].ty;
    discrete(a) && discrete(b.variable) && same && !b.negated
}

/// Whether a variable is a Real parameter that initialization determines.
fn is_found(draft: &DaeDraft, v: VarId) -> bool {
    draft.role(v) == SystemRole::FreeParameter && draft.variables[v.index()].ty == ScalarType::Real
}

/// Shares the start value between a free parameter and a variable that equals it: whichever has none takes that of the
/// other as its guess.
fn share_guess(draft: &mut DaeDraft, parameter: VarId, equal: SignedVariable) {
    if draft.role(equal.variable) != SystemRole::Continuous {
        return;
    }
    let (p, v) = (&draft.variables[parameter.index()], &draft.variables[equal.variable.index()]);
    let (from, to) = match (p.start, v.start) {
        (Some(start), None) if !v.fixed => (start, equal.variable),
        (None, Some(start)) => (start, parameter),
        _ => return,
    };
    draft.variables[to.index()].start = Some(signed(&mut draft.exprs, from, equal.negated));
}

/// Processes equations `w = der(x)`: links `x` to `w` unless that closes a circle. If `x` has a derivative already, `w`
/// becomes an alias of it. An equation that a link or a join expresses is not kept.
///
/// Each entry of `links` is the number of an equation, the variable `w` and the variable `x` of `w = der(x)`, both
/// signed. `kept` is set to false for equations that are expressed by links.
fn link_derivatives(
    draft: &mut DaeDraft,
    classes: &mut AliasClasses,
    links: &[(usize, SignedVariable, SignedVariable)],
    kept: &mut [bool],
) {
    let unknown = |v: VarId| draft.role(v) == SystemRole::Continuous;
    let candidates: Vec<_> =
        links.iter().filter(|(_, w, of)| unknown(w.variable) && unknown(of.variable)).copied().collect();
    for (i, w, of) in candidates {
        // An earlier link may have joined sets, so the roots are looked up anew for each equation.
        let (w, of) = (classes.find(w.variable), classes.find_signed(of));
        // w.variable = +-(w.negated, of.negated) der(of.variable)
        let derivative = SignedVariable { variable: w.variable, negated: w.negated != of.negated };
        kept[i] = !classes.link(draft, of.variable, derivative);
    }
}

/// Drops the equations that are not kept, and their roles.
fn retain(draft: &mut DaeDraft, kept: &[bool]) {
    let mut keep = kept.iter();
    draft.equations.retain(|_| *keep.next().expect("one flag an equation"));
    let mut keep = kept.iter();
    draft.kinds.retain(|_| *keep.next().expect("one flag an equation"));
}

/// Alias sets: a union-find forest over all variables in which each edge has a sign. Fields "by root" are valid at the
/// root of a set only.
struct AliasClasses {
    /// By variable: its parent in the forest, with the sign between the two. A root is its own parent.
    parent: Vec<SignedVariable>,
    /// By root: how many variables the set has, for union by size.
    size: Vec<u32>,
    /// By root: whether the set contains an input or a sample, which no equation may determine.
    given: Vec<bool>,
    /// By root: the variable that is its time derivative.
    derivative: Vec<Option<SignedVariable>>,
    /// By root: a variable whose time derivative it is.
    integral: Vec<Option<VarId>>,
}

impl AliasClasses {
    /// Each variable in a set of its own.
    fn new(draft: &DaeDraft) -> Self {
        let count = draft.variables.len();
        AliasClasses {
            parent: (0..count as u32).map(|i| SignedVariable { variable: VarId(i), negated: false }).collect(),
            size: vec![1; count],
            given: draft.roles.iter().map(|role| matches!(role, SystemRole::Input | SystemRole::Sample)).collect(),
            derivative: vec![None; count],
            integral: vec![None; count],
        }
    }

    /// The root of a variable's set, and the sign of the variable relative to it. Compresses the path.
    /// Almost constant time on average.
    fn find(&mut self, v: VarId) -> SignedVariable {
        let mut root = SignedVariable { variable: v, negated: false };
        while self.parent[root.variable.index()].variable != root.variable {
            let next = self.parent[root.variable.index()];
            root = SignedVariable { variable: next.variable, negated: root.negated != next.negated };
        }
        // Point everything on the way at the root.
        // Second pass, path compression: every variable on the way gets the root as its parent, with its own sign.
        let mut at = SignedVariable { variable: v, negated: root.negated };
        while self.parent[at.variable.index()].variable != root.variable && at.variable != root.variable {
            let next = self.parent[at.variable.index()];
            self.parent[at.variable.index()] = SignedVariable { variable: root.variable, negated: at.negated };
            at = SignedVariable { variable: next.variable, negated: at.negated != next.negated };
        }
        root
    }

    /// The root of a signed variable, with the combined sign.
    /// Two negatives cancel.
    fn find_signed(&mut self, v: SignedVariable) -> SignedVariable {
        let root = self.find(v.variable);
        SignedVariable { variable: root.variable, negated: root.negated != v.negated }
    }

    /// Makes `a` equal `b`. False where that is impossible (two given values, or a circle of derivatives) or where both
    /// are in one set already; then the equation stays.
    ///
    /// Joining two variables also joins their derivatives, if both have one. So one alias equation may make several
    /// pairs equal.
    fn join(&mut self, draft: &DaeDraft, a: VarId, b: SignedVariable) -> bool {
        let (a, b) = (self.find(a), self.find_signed(b));
        if a.variable == b.variable || !self.gifts_fit(a.variable, b.variable) || !self.chains_fit(a, b) {
            return false;
        }
        let negated = a.negated != b.negated;
        let (small, large) = if self.size[a.variable.index()] < self.size[b.variable.index()] {
            (a.variable, b.variable)
        } else {
            (b.variable, a.variable)
        };
        self.parent[small.index()] = SignedVariable { variable: large, negated };
        self.size[large.index()] += self.size[small.index()];
        self.given[large.index()] |= self.given[small.index()];
        self.carry_links(draft, small, SignedVariable { variable: large, negated });
        true
    }

    /// Whether two sets may be joined as far as given variables go. Two given variables stay apart. A given variable
    /// and a member of a chain of derivatives stay apart too: the chain would lose the equation that determines it.
    /// A set without given values may be joined with any other, as far as this rule goes.
    fn gifts_fit(&self, a: VarId, b: VarId) -> bool {
        let linked = |v: VarId| self.derivative[v.index()].is_some() || self.integral[v.index()].is_some();
        match (self.given[a.index()], self.given[b.index()]) {
            (true, true) => false,
            (true, false) => !linked(b),
            (false, true) => !linked(a),
            (false, false) => true,
        }
    }

    /// Whether the derivatives of both, as far as they are linked, can be made equal too. Walks both chains upwards.
    /// False where the chains would form a circle, or where a variable would equal its own negative.
    fn chains_fit(&mut self, a: SignedVariable, b: SignedVariable) -> bool {
        let (mut a, mut b) = (a, b);
        while a.variable != b.variable {
            if self.would_close_circle(a.variable, b.variable) {
                return false;
            }
            let (Some(da), Some(db)) = (self.derivative[a.variable.index()], self.derivative[b.variable.index()])
            else {
                return true;
            };
            let (da, db) = (self.find_signed(da), self.find_signed(db));
            a = SignedVariable { variable: da.variable, negated: da.negated != a.negated };
            b = SignedVariable { variable: db.variable, negated: db.negated != b.negated };
        }
        // The chains meet in one set: then the signs must agree, else the derivative would equal its own negative.
        a.negated == b.negated
    }

    /// Moves the links of `small` to `large` after `small` joined it. If both have a derivative, these become equal
    /// too.
    /// The sign of `large` is that of `small` relative to it.
    fn carry_links(&mut self, draft: &DaeDraft, small: VarId, large: SignedVariable) {
        if let Some(of) = self.integral[small.index()].take() {
            // Both sides of a link stay valid after joins, because readers look up the root.
            self.integral[large.variable.index()].get_or_insert(of);
        }
        if let Some(d) = self.derivative[small.index()].take() {
            let turned = SignedVariable { variable: d.variable, negated: d.negated != large.negated };
            match self.derivative[large.variable.index()] {
                Some(own) => {
                    let same = SignedVariable { variable: own.variable, negated: own.negated != turned.negated };
                    self.join(draft, turned.variable, same);
                }
                None => self.derivative[large.variable.index()] = Some(turned),
            }
        }
    }

    /// Makes `d` the derivative of the root `of`. If `of` has a derivative already, the two are joined instead. False
    /// where one of the two is given from outside, where `d` is the derivative of another variable already, or where a
    /// circle would close; then the equation stays.
    ///
    /// `of` must be a root. The derivative may be any member of its set; readers look up its root.
    fn link(&mut self, draft: &DaeDraft, of: VarId, d: SignedVariable) -> bool {
        if let Some(own) = self.derivative[of.index()] {
            let same = SignedVariable { variable: own.variable, negated: own.negated != d.negated };
            return self.join(draft, d.variable, same);
        }
        if self.given[of.index()] || self.given[d.variable.index()] || self.reaches(d.variable, of) {
            return false;
        }
        // A variable is the derivative of one other at most, so that chains do not branch.
        if self.integral[d.variable.index()].is_some() {
            return false;
        }
        self.derivative[of.index()] = Some(d);
        self.integral[d.variable.index()] = Some(of);
        true
    }

    /// Whether `to` is in the set of `from` or in that of one of its derivatives.
    fn reaches(&mut self, from: VarId, to: VarId) -> bool {
        let to = self.find(to).variable;
        let mut at = self.find(from).variable;
        loop {
            if at == to {
                return true;
            }
            match self.derivative[at.index()] {
                Some(next) => at = self.find(next.variable).variable,
                None => return false,
            }
        }
    }

    /// Whether joining two sets breaks the chains: two members of one chain would make it a circle, and derivatives of
    /// different variables would make a variable the derivative of two.
    /// Sets without links are joined without further tests.
    fn would_close_circle(&mut self, a: VarId, b: VarId) -> bool {
        let linked = |s: &Self, v: VarId| s.derivative[v.index()].is_some() || s.integral[v.index()].is_some();
        if !linked(self, a) && !linked(self, b) {
            return false;
        }
        if self.reaches(a, b) || self.reaches(b, a) {
            return true;
        }
        match (self.integral[a.index()], self.integral[b.index()]) {
            (Some(x), Some(y)) => self.find(x).variable != self.find(y).variable,
            _ => false,
        }
    }

    /// Chooses the representative of each set and stores the links between representatives in the draft. By variable:
    /// its representative with the sign. `differentiated` adds the variables of link equations, which may have been
    /// removed.
    /// Linear in the number of variables; ties go to the variable declared first.
    fn settle(&mut self, draft: &mut DaeDraft, differentiated: impl Iterator<Item = VarId>) -> Vec<SignedVariable> {
        let count = draft.variables.len();
        let ranks = ranks(draft, differentiated);
        let mut best: Vec<Option<VarId>> = vec![None; count];
        for v in (0..count as u32).map(VarId) {
            let slot = self.find(v).variable.index();
            if best[slot].is_none_or(|b| ranks[v.index()] > ranks[b.index()]) {
                best[slot] = Some(v);
            }
        }
        self.store_links(draft, &best);
        let target = |v: VarId| {
            let root = self.find(v);
            let variable = best[root.variable.index()].expect("every class has a best member");
            SignedVariable { variable, negated: root.negated != self.find(variable).negated }
        };
        (0..count as u32).map(VarId).map(target).collect()
    }

    /// Writes the links to `DaeDraft::derivative`, in terms of the representatives.
    fn store_links(&mut self, draft: &mut DaeDraft, best: &[Option<VarId>]) {
        for root in 0..self.derivative.len() {
            let Some(d) = self.derivative[root] else { continue };
            let of = best[root].expect("a root has a class");
            let d_root = self.find(d.variable);
            let w = best[d_root.variable.index()].expect("a root has a class");
            // The link holds between roots; the signs of both representatives relative to their roots go into it.
            let negated = self.find(of).negated ^ d.negated ^ d_root.negated ^ self.find(w).negated;
            draft.derivative[of.index()] = Some(SignedVariable { variable: w, negated });
        }
    }
}

/// The variables that are not their own representative.
fn aliases(targets: &[SignedVariable]) -> Vec<Alias> {
    let pairs = targets.iter().enumerate().filter(|(i, t)| t.variable.index() != *i);
    pairs.map(|(i, t)| Alias { variable: VarId(i as u32), target: t.variable, negated: t.negated }).collect()
}

/// What makes a variable the better representative of its set; larger wins. In order of weight: given from outside,
/// differentiated, `stateSelect`, fixed, with a start value, not hidden, no flow, a short name, an early declaration.
type AliasRank = (bool, bool, StateSelect, bool, bool, bool, bool, std::cmp::Reverse<usize>, std::cmp::Reverse<usize>);

/// The rank of every variable.
/// `named` are variables that are differentiated by equations that the links have replaced.
fn ranks(draft: &mut DaeDraft, named: impl Iterator<Item = VarId>) -> Vec<AliasRank> {
    let mut differentiated = vec![false; draft.variables.len()];
    named.for_each(|v| differentiated[v.index()] = true);
    for (i, _) in draft.live_nodes().iter().enumerate().filter(|(_, live)| **live) {
        if let ExprNode::Der(v) = draft.exprs.node(ExprId(i as u32)) {
            differentiated[v.index()] = true;
        }
    }
    let rank = |(i, v): (usize, &crate::flat::FlatVariable)| {
        (
            matches!(draft.roles[i], SystemRole::Input | SystemRole::Sample),
            differentiated[i],
            v.state_select,
            v.fixed,
            v.start.is_some(),
            !v.hidden,
            !v.flow,
            std::cmp::Reverse(v.name.len()),
            std::cmp::Reverse(i),
        )
    };
    draft.variables.iter().enumerate().map(rank).collect()
}

/// Merges the attributes of an alias into its target: start and `fixed`, `nominal`, `stateSelect`, and whether a `when`
/// assigns it. `min` and `max` are not merged.
///
/// Two starts that both are conditions are compared by [`compare_starts`]. `nominal` is taken over where the target has
/// none.
fn merge(draft: &mut DaeDraft, known: &mut parameters::SignAnalysis, alias: Alias, diagnostics: &mut Vec<Diagnostic>) {
    let from = draft.variables[alias.variable.index()].clone();
    let start = from.start.map(|e| if alias.negated { draft.exprs.neg(e) } else { e });
    draft.when_assigned[alias.target.index()] |= draft.when_assigned[alias.variable.index()];
    let target = &draft.variables[alias.target.index()];
    if from.start_is_said() && target.start_is_said() {
        compare_starts(draft, known, alias, start, diagnostics);
    }
    let target = &mut draft.variables[alias.target.index()];
    // A fixed start counts before a guess; of two guesses the one given further outside counts (MLS 8.6.2).
    if from.fixed && !target.fixed {
        target.start = start;
        target.fixed = true;
    } else if !target.fixed && start.is_some() && (target.start.is_none() || from.confidence < target.confidence) {
        target.start = start;
        target.confidence = from.confidence;
    }
    if target.nominal.is_none() {
        target.nominal = from.nominal;
    }
    target.state_select = merged_select(target.state_select, from.state_select);
}

/// The `stateSelect` of an alias set: the strongest wish for a state counts; without one, the strongest wish against
/// it.
/// `always` beats `prefer`, `never` beats `avoid`, and any wish for a state beats a wish against one.
fn merged_select(a: StateSelect, b: StateSelect) -> StateSelect {
    match (a, b) {
        (StateSelect::Default, other) | (other, StateSelect::Default) => other,
        _ if a.max(b) > StateSelect::Default => a.max(b),
        _ => a.min(b),
    }
}

/// Compares two starts that both are conditions. Values that differ now are reported. Others become an initial check,
/// because parameters may change between runs.
/// The tolerance is relative, so that rounding of unit conversions is no contradiction.
fn compare_starts(
    draft: &mut DaeDraft,
    known: &mut parameters::SignAnalysis,
    alias: Alias,
    start: Option<ExprId>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let ours = draft.variables[alias.target.index()].start.unwrap_or(Exprs::ZERO);
    let theirs = start.unwrap_or(Exprs::ZERO);
    let difference = draft.exprs.sub(ours, theirs);
    if difference == Exprs::ZERO {
        return;
    }
    let size = known.value(&draft.exprs, ours).unwrap_or(f64::NAN);
    let gap = known.value(&draft.exprs, difference).unwrap_or(f64::NAN);
    // NaN, for a value that is not known before the run, compares false and leads to the check.
    if gap.abs() > 1e-9 * size.abs().max(1e-12) {
        diagnostics.push(messages::contradicting_aliases(draft, known, alias));
    } else {
        let origin = ElementOrigin { kind: OriginKind::Start, ..draft.variables[alias.variable.index()].origin };
        draft.initial_checks.push(FlatEquation { lhs: ours, rhs: theirs, origin });
    }
}

/// Replaces aliases and linked derivatives in all expressions, actions and crossings.
/// `Der(v)` becomes the linked variable if there is one, with the combined sign.
fn rewrite(draft: &mut DaeDraft, targets: &[SignedVariable]) {
    let derivative = draft.derivative.clone();
    let roles = draft.roles.clone();
    let map = draft.rewritten(|pool, node| match node {
        ExprNode::Var(v) => Some(targets[v.index()].expression(pool)),
        ExprNode::Der(v) => {
            let target = targets[v.index()];
            if !matches!(roles[target.variable.index()], SystemRole::Continuous | SystemRole::Input) {
                // The derivative of what changes at events only, or not at all, is 0.
                return Some(Exprs::ZERO);
            }
            let (e, turned) = match derivative[target.variable.index()] {
                Some(w) => (pool.var(w.variable), w.negated),
                None => (pool.der(target.variable), false),
            };
            Some(signed(pool, e, target.negated != turned))
        }
        ExprNode::Pre(v) => {
            let e = pool.pre(targets[v.index()].variable);
            Some(signed(pool, e, targets[v.index()].negated))
        }
        _ => None,
    });
    draft.map_expressions(&map);
    // `map_expressions` has rewritten the values; variables that are no expressions follow here.
    for action in &mut draft.actions {
        if let EventActionKind::Reinit(v, value) = &mut action.kind {
            let target = targets[v.index()];
            *v = target.variable;
            *value = signed(&mut draft.exprs, *value, target.negated);
        }
    }
    for crossing in &mut draft.crossings {
        crossing.mode = targets[crossing.mode.index()].variable;
    }
}

/// The expression, or its negative.
fn signed(pool: &mut Exprs, e: ExprId, negated: bool) -> ExprId {
    if negated { pool.neg(e) } else { e }
}
