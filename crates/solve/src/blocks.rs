//! Execution of the sorted blocks of the event system or the initial system.
//!
//! `events` and `initialize` call [`BlockWorkspace::run`] with the array of values. Assignments run their programs,
//! algebraic loops are solved by `newton`. Mixed loops (MLS appendix C: discrete and continuous equations that depend
//! on each other) are solved by a search over their discrete values: a fixed-point iteration first, then single
//! changes, then combinations of modes.

use super::modes::CrossingModes;
use super::newton::{Newton, NewtonFailure, NewtonFailureReason, VariableScales};
use super::stale::StaleBlocks;
use crate::lower::{AssignCode, AssignTarget, BlockCode, ExecutableSystem, LoopCode, MixedCode};
use bramah_expr::VarId;
use bramah_model::structure::Unknown;

/// Passes of a fixed-point iteration through a mixed loop.
const PASSES: usize = 40;
/// Number of modes of a mixed loop up to which all combinations are tried.
const COMBINED: usize = 10;

/// Why the blocks could not be solved.
#[derive(Clone, Debug, PartialEq)]
pub enum BlockFailure {
    /// An algebraic loop has no solution.
    Loop(Box<NewtonFailure>),
    /// An explicit value is not finite.
    NonFinite(AssignTarget),
    /// No discrete values of a mixed loop are consistent.
    ///
    /// Holds the discrete variables, and the unknown that the equations left undetermined with some of their values.
    Mixed(Vec<VarId>, Option<Unknown>),
}

/// What all blocks need to run.
pub struct BlockContext<'a> {
    /// The lowered model.
    pub system: &'a ExecutableSystem,
    /// Sizes and bounds of all variables.
    pub scales: &'a VariableScales,
    /// Corrections of modes that have just crossed.
    pub modes: &'a CrossingModes,
}

/// Workspace of a list of blocks, allocated once.
#[derive(Debug, Default)]
pub struct BlockWorkspace {
    /// The workspace of each block, in the order of the blocks.
    work: Vec<BlockWork>,
}

/// The workspace of one block, by its kind.
#[derive(Debug)]
enum BlockWork {
    /// The modes among the targets.
    Assign(ModeCorrections),
    /// The Newton solver.
    Loop(Box<Newton>),
    /// The workspace of the mixed loop.
    Mixed(Box<MixedWork>),
}

/// Slot and crossing of each mode that an assignment program computes.
type ModeCorrections = Vec<(usize, u32)>;

/// Workspace of a mixed loop.
#[derive(Debug)]
struct MixedWork {
    /// Workspace of its continuous blocks.
    continuous: Vec<BlockWork>,
    /// For each discrete program its modes.
    corrections: Vec<ModeCorrections>,
    /// Slots of all discrete targets, in order.
    slots: Vec<usize>,
    /// The variables of these slots.
    targets: Vec<VarId>,
    /// Indices in `slots` that are modes of crossings.
    modes: Vec<usize>,
    /// The unknown that a singular matrix left undetermined during the search.
    undetermined: Option<Unknown>,
    /// Whether the last solution kept the value of that unknown.
    keeps: bool,
}

impl BlockWorkspace {
    /// Allocates the workspace of these blocks.
    pub fn new(code: &[BlockCode], scales: &VariableScales, modes: &CrossingModes) -> Self {
        BlockWorkspace { work: code.iter().map(|b| BlockWork::new(b, scales, modes)).collect() }
    }

    /// The unknown that the equations left open in the last solution, and the discrete variables of its loop.
    pub fn kept(&self) -> Option<(&[VarId], Unknown)> {
        self.work.iter().find_map(|work| match work {
            BlockWork::Mixed(mixed) if mixed.keeps => Some((mixed.targets.as_slice(), mixed.undetermined?)),
            _ => None,
        })
    }

    /// Sets whether loops may end at another root than the present one ([`Newton::may_jump`]).
    pub fn may_jump(&mut self, allowed: bool) {
        self.work.iter_mut().for_each(|work| work.may_jump(allowed));
    }

    /// Whether a loop was solved by a search in the last run ([`Newton::searched`]).
    pub fn searched(&self) -> bool {
        self.work.iter().any(BlockWork::searched)
    }

    /// Solves all blocks in order.
    ///
    /// # Errors
    /// The first block that fails.
    pub fn run(
        &mut self,
        code: &[BlockCode],
        setting: &BlockContext<'_>,
        values: &mut [f64],
    ) -> Result<(), BlockFailure> {
        code.iter().zip(&mut self.work).try_for_each(|(code, work)| work.run(code, setting, values))
    }

    /// Solves those blocks that are stale, in order.
    ///
    /// # Errors
    /// The first block that fails.
    pub fn run_stale(
        &mut self,
        stale: &mut StaleBlocks,
        code: &[BlockCode],
        setting: &BlockContext<'_>,
        values: &mut [f64],
    ) -> Result<(), BlockFailure> {
        for (number, (code, work)) in code.iter().zip(&mut self.work).enumerate() {
            if stale.take(number, values) {
                work.run(code, setting, values)?;
                stale.compare(number, values);
            }
        }
        Ok(())
    }
}

impl BlockWork {
    /// Allocates the workspace of one block.
    fn new(code: &BlockCode, scales: &VariableScales, modes: &CrossingModes) -> Self {
        match code {
            BlockCode::Assign(assign) => BlockWork::Assign(corrections(assign, modes)),
            BlockCode::Loop(code) => BlockWork::Loop(Box::new(Newton::new(code, scales))),
            BlockCode::Mixed(mixed) => BlockWork::Mixed(Box::new(MixedWork::new(mixed, scales, modes))),
        }
    }

    /// As [`BlockWorkspace::may_jump`].
    fn may_jump(&mut self, allowed: bool) {
        match self {
            BlockWork::Assign(_) => {}
            BlockWork::Loop(newton) => newton.may_jump(allowed),
            BlockWork::Mixed(mixed) => mixed.continuous.iter_mut().for_each(|work| work.may_jump(allowed)),
        }
    }

    /// As [`BlockWorkspace::searched`].
    fn searched(&self) -> bool {
        match self {
            BlockWork::Assign(_) => false,
            BlockWork::Loop(newton) => newton.searched(),
            BlockWork::Mixed(mixed) => mixed.continuous.iter().any(BlockWork::searched),
        }
    }

    /// Solves one block.
    fn run(&mut self, code: &BlockCode, setting: &BlockContext<'_>, values: &mut [f64]) -> Result<(), BlockFailure> {
        match (self, code) {
            (BlockWork::Assign(corrections), BlockCode::Assign(assign)) => {
                run_assign(assign, corrections, setting, values);
                check_finite(&assign.targets, values)
            }
            (BlockWork::Loop(newton), BlockCode::Loop(code)) => run_loop(newton, code, setting, values),
            (BlockWork::Mixed(work), BlockCode::Mixed(mixed)) => work.run(mixed, setting, values),
            _ => unreachable!("work space is made from the same blocks"),
        }
    }
}

/// Solves an algebraic loop and checks its inner variables.
fn run_loop(
    newton: &mut Newton,
    code: &LoopCode,
    setting: &BlockContext<'_>,
    values: &mut [f64],
) -> Result<(), BlockFailure> {
    newton.solve(code, setting.scales, values).map_err(|f| BlockFailure::Loop(Box::new(f)))?;
    check_finite(&code.inner, values)
}

/// `Err` with the first target whose value is not finite.
fn check_finite(targets: &[AssignTarget], values: &[f64]) -> Result<(), BlockFailure> {
    match targets.iter().find(|t| !values[t.slot].is_finite()) {
        None => Ok(()),
        Some(target) => Err(BlockFailure::NonFinite(*target)),
    }
}

/// The modes among the targets of an assignment program.
fn corrections(code: &AssignCode, modes: &CrossingModes) -> ModeCorrections {
    code.targets
        .iter()
        .filter_map(|t| match t.unknown {
            Unknown::Var(v) => Some((t.slot, modes.crossing(v)?)),
            Unknown::Der(_) => None,
        })
        .collect()
}

/// Runs an assignment program and corrects its modes.
fn run_assign(code: &AssignCode, corrections: &ModeCorrections, setting: &BlockContext<'_>, values: &mut [f64]) {
    code.program.run(values);
    for &(slot, crossing) in corrections {
        values[slot] = setting.modes.correct(setting.system, crossing, values[slot], values);
    }
}

impl MixedWork {
    /// Allocates the workspace of a mixed loop.
    fn new(code: &MixedCode, scales: &VariableScales, modes: &CrossingModes) -> Self {
        let targets: Vec<&AssignTarget> = code.discrete.iter().flat_map(|a| &a.targets).collect();
        let variable = |t: &&AssignTarget| match t.unknown {
            Unknown::Var(v) | Unknown::Der(v) => v,
        };
        let ids: Vec<VarId> = targets.iter().map(variable).collect();
        MixedWork {
            continuous: code.continuous.iter().map(|b| BlockWork::new(b, scales, modes)).collect(),
            corrections: code.discrete.iter().map(|a| corrections(a, modes)).collect(),
            slots: targets.iter().map(|t| t.slot).collect(),
            modes: (0..ids.len()).filter(|&i| modes.crossing(ids[i]).is_some()).collect(),
            targets: ids,
            undetermined: None,
            keeps: false,
        }
    }

    /// Sets whether the continuous loops may leave undetermined unknowns as they are.
    fn may_keep(&mut self, allowed: bool) {
        for work in &mut self.continuous {
            if let BlockWork::Loop(newton) = work {
                newton.may_keep(allowed);
            }
        }
    }

    /// Solves the loop. Where no discrete values determine everything, undetermined unknowns keep their value.
    ///
    /// They may only do so while the equations that are left over hold. Example: two dry frictions hold one shaft, and
    /// each continues with the load that it has.
    fn run(&mut self, code: &MixedCode, setting: &BlockContext<'_>, values: &mut [f64]) -> Result<(), BlockFailure> {
        let start = self.read(values);
        self.undetermined = None;
        self.keeps = false;
        let end = self.determine(code, setting, values, &start);
        // only a singular matrix justifies the second attempt
        if end.is_ok() || self.undetermined.is_none() {
            return end;
        }
        self.write(&start, values);
        self.may_keep(true);
        let kept = self.determine(code, setting, values, &start);
        self.keeps =
            kept.is_ok() && self.continuous.iter().any(|w| matches!(w, BlockWork::Loop(newton) if newton.keeps()));
        self.may_keep(false);
        kept.or(end)
    }

    /// Solves with the modes that the integrator has seen cross, and without them where that is contradictory.
    ///
    /// The crossing was then seen within the error of the solution but too early, and it will be seen again.
    fn determine(
        &mut self,
        code: &MixedCode,
        setting: &BlockContext<'_>,
        values: &mut [f64],
        start: &[f64],
    ) -> Result<(), BlockFailure> {
        match self.search(code, setting, values, start) {
            Err(BlockFailure::Mixed(..)) if setting.modes.forces() => {
                self.write(start, values);
                let mut modes = setting.modes.clone();
                modes.release();
                self.search(code, &BlockContext { modes: &modes, ..*setting }, values, start)
            }
            end => end,
        }
    }

    /// Tries a fixed-point iteration, then one change at a time, then combinations of modes.
    fn search(
        &mut self,
        code: &MixedCode,
        setting: &BlockContext<'_>,
        values: &mut [f64],
        start: &[f64],
    ) -> Result<(), BlockFailure> {
        for single in [false, true] {
            self.write(start, values);
            match self.iterate(code, setting, values, single) {
                Ok(true) => return Ok(()),
                // values on the way may have no solution although the consistent ones do
                Ok(false) | Err(BlockFailure::Loop(_) | BlockFailure::NonFinite(_)) => {}
                Err(other) => return Err(other),
            }
        }
        self.write(start, values);
        self.combine(code, setting, values, start)
    }

    /// The present discrete values.
    fn read(&self, values: &[f64]) -> Vec<f64> {
        self.slots.iter().map(|&s| values[s]).collect()
    }

    /// Sets the discrete values.
    fn write(&self, discrete: &[f64], values: &mut [f64]) {
        for (&slot, v) in self.slots.iter().zip(discrete) {
            values[slot] = *v;
        }
    }

    /// Solves the continuous blocks with the present discrete values. Records an unknown that a singular matrix left
    /// open.
    fn solve_continuous(
        &mut self,
        code: &MixedCode,
        setting: &BlockContext<'_>,
        values: &mut [f64],
    ) -> Result<(), BlockFailure> {
        let solved = code.continuous.iter().zip(&mut self.continuous).try_for_each(|(c, w)| w.run(c, setting, values));
        if let Err(BlockFailure::Loop(failure)) = &solved
            && let NewtonFailureReason::Singular(unknown) = failure.reason
        {
            self.undetermined = Some(unknown);
        }
        solved
    }

    /// Computes the discrete values from the continuous ones.
    fn run_discrete(&self, code: &MixedCode, setting: &BlockContext<'_>, values: &mut [f64]) {
        for (assign, corrections) in code.discrete.iter().zip(&self.corrections) {
            run_assign(assign, corrections, setting, values);
        }
    }

    /// The fixed-point iteration; with `single`, only one discrete value changes in each pass.
    ///
    /// `Ok(true)` when the discrete values no longer change, `Ok(false)` when they repeat without end or change for too
    /// many passes. `Err` when the continuous blocks have no solution on the way.
    fn iterate(
        &mut self,
        code: &MixedCode,
        setting: &BlockContext<'_>,
        values: &mut [f64],
        single: bool,
    ) -> Result<bool, BlockFailure> {
        let mut seen: Vec<Vec<f64>> = vec![self.read(values)];
        for _ in 0..PASSES {
            self.solve_continuous(code, setting, values)?;
            let old = seen.last().expect("never empty").clone();
            self.run_discrete(code, setting, values);
            let mut new = self.read(values);
            if new == old {
                return Ok(true);
            }
            if single {
                new = first_change(&old, &new, &self.modes);
                self.write(&new, values);
            }
            // a state that has occurred before would lead to the same sequence again
            if seen.contains(&new) {
                return Ok(false);
            }
            seen.push(new);
        }
        Ok(false)
    }

    /// Tries all combinations of the modes of relations, those with the fewest changes first.
    ///
    /// With more than [`COMBINED`] modes nothing is tried. `Err` when no combination reproduces itself.
    fn combine(
        &mut self,
        code: &MixedCode,
        setting: &BlockContext<'_>,
        values: &mut [f64],
        start: &[f64],
    ) -> Result<(), BlockFailure> {
        // only modes with the values of a relation, 0 or 1, can be inverted
        let relations: Vec<usize> =
            self.modes.iter().copied().filter(|&i| start[i] == 0.0 || start[i] == 1.0).collect();
        if relations.len() <= COMBINED {
            let mut combinations: Vec<u32> = (0..1 << relations.len()).collect();
            combinations.sort_by_key(|c: &u32| c.count_ones());
            let wanted = || combinations.iter().map(|&flips| flipped(start, &relations, flips));
            if wanted().any(|wanted| self.fits(code, setting, values, &wanted)) {
                return Ok(());
            }
            // a second round accepts modes whose difference is within the error of the solution
            let mut modes = setting.modes.clone();
            for wanted in wanted() {
                relations.iter().for_each(|&i| self.hold(&mut modes, i, wanted[i]));
                if self.fits(code, &BlockContext { modes: &modes, ..*setting }, values, &wanted) {
                    return Ok(());
                }
            }
        }
        // the message refers to the start values
        self.write(start, values);
        self.solve_continuous(code, setting, values)?;
        Err(BlockFailure::Mixed(self.targets.clone(), self.undetermined))
    }

    /// Lets a mode keep a value while its two sides differ by less than the error of the solution.
    ///
    /// Where a current and a voltage vanish together, rounding decides on which side of 0 they lie, and no value of a
    /// mode may reproduce itself exactly.
    fn hold(&self, modes: &mut CrossingModes, target: usize, value: f64) {
        if let Some(crossing) = modes.crossing(self.targets[target]) {
            modes.hold(crossing, value);
        }
    }

    /// Whether these discrete values reproduce themselves: solving with them gives them again.
    fn fits(&mut self, code: &MixedCode, setting: &BlockContext<'_>, values: &mut [f64], wanted: &[f64]) -> bool {
        self.write(wanted, values);
        self.settle_others(code, setting, values, wanted);
        let before = self.read(values);
        if self.solve_continuous(code, setting, values).is_err() {
            return false;
        }
        self.run_discrete(code, setting, values);
        self.read(values) == before
    }

    /// Computes discrete values that depend on the modes, with the modes held at `wanted`.
    fn settle_others(&self, code: &MixedCode, setting: &BlockContext<'_>, values: &mut [f64], wanted: &[f64]) {
        // discrete values may read each other: a few passes let them follow
        for _ in 0..3 {
            let mut at = 0;
            for (assign, corrections) in code.discrete.iter().zip(&self.corrections) {
                run_assign(assign, corrections, setting, values);
                if !corrections.is_empty() {
                    for (k, target) in assign.targets.iter().enumerate() {
                        values[target.slot] = wanted[at + k];
                    }
                }
                at += assign.targets.len();
            }
        }
    }
}

/// The start values with some of the relations inverted; bit k of `flips` inverts relation k.
fn flipped(start: &[f64], relations: &[usize], flips: u32) -> Vec<f64> {
    let mut wanted = start.to_vec();
    for (bit, &i) in relations.iter().enumerate() {
        if flips >> bit & 1 == 1 {
            wanted[i] = 1.0 - start[i];
        }
    }
    wanted
}

/// The old values with one change: the first mode that differs, else the first value that differs.
fn first_change(old: &[f64], new: &[f64], modes: &[usize]) -> Vec<f64> {
    let mut result = old.to_vec();
    let changed = modes.iter().copied().chain(0..old.len()).find(|&i| old[i] != new[i]);
    if let Some(i) = changed {
        result[i] = new[i];
        // what is no mode follows the modes of the next pass
        for k in 0..old.len() {
            if !modes.contains(&k) && modes.contains(&i) {
                result[k] = new[k];
            }
        }
    }
    result
}
