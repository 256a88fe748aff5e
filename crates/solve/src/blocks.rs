//! Running the sorted blocks of the event or initial system: assignments, algebraic loops, loops through discrete
//! equations.

use super::modes::CrossingModes;
use super::newton::{Newton, NewtonFailure, NewtonFailureReason, VariableScales};
use super::stale::StaleBlocks;
use crate::lower::{AssignCode, AssignTarget, BlockCode, ExecutableSystem, LoopCode, MixedCode};
use bramah_expr::VarId;
use bramah_model::structure::Unknown;

/// Passes through a mixed loop before single changes are tried, and again before combinations are.
const PASSES: usize = 40;
/// Modes of a mixed loop whose combinations are tried at most.
const COMBINED: usize = 10;

/// Why the blocks could not be solved.
#[derive(Clone, Debug, PartialEq)]
pub enum BlockFailure {
    /// An algebraic loop.
    Loop(Box<NewtonFailure>),
    /// An explicit value that is not finite.
    NonFinite(AssignTarget),
    /// Discrete values of a mixed loop that contradict each other whatever is tried; and what the equations did not
    /// determine with some of these values.
    Mixed(Vec<VarId>, Option<Unknown>),
}

/// What all blocks share.
pub struct BlockContext<'a> {
    /// The model.
    pub system: &'a ExecutableSystem,
    /// Sizes and bounds.
    pub scales: &'a VariableScales,
    /// Corrections of modes.
    pub modes: &'a CrossingModes,
}

/// Work space for a list of blocks, allocated once.
#[derive(Debug, Default)]
pub struct BlockWorkspace {
    work: Vec<BlockWork>,
}

#[derive(Debug)]
enum BlockWork {
    Assign(ModeCorrections),
    Loop(Box<Newton>),
    Mixed(Box<MixedWork>),
}

/// Slot and crossing of each mode that an assignment program computes.
type ModeCorrections = Vec<(usize, u32)>;

#[derive(Debug)]
struct MixedWork {
    continuous: Vec<BlockWork>,
    corrections: Vec<ModeCorrections>,
    /// Slots of all discrete targets, in order.
    slots: Vec<usize>,
    targets: Vec<VarId>,
    /// Positions in `slots` that are modes.
    modes: Vec<usize>,
    /// What a singular matrix left undetermined in a search.
    undetermined: Option<Unknown>,
    /// Whether the last solution left it as it was.
    keeps: bool,
}

impl BlockWorkspace {
    /// Work space for these blocks.
    pub fn new(code: &[BlockCode], scales: &VariableScales, modes: &CrossingModes) -> Self {
        BlockWorkspace { work: code.iter().map(|b| BlockWork::new(b, scales, modes)).collect() }
    }

    /// What the equations left open in the last solution, and what switched there.
    pub fn kept(&self) -> Option<(&[VarId], Unknown)> {
        self.work.iter().find_map(|work| match work {
            BlockWork::Mixed(mixed) if mixed.keeps => Some((mixed.targets.as_slice(), mixed.undetermined?)),
            _ => None,
        })
    }

    /// Whether loops may end at another root than that at hand ([`Newton::may_jump`]).
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

    /// Solves those that are stale, in order.
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
    fn new(code: &BlockCode, scales: &VariableScales, modes: &CrossingModes) -> Self {
        match code {
            BlockCode::Assign(assign) => BlockWork::Assign(corrections(assign, modes)),
            BlockCode::Loop(code) => BlockWork::Loop(Box::new(Newton::new(code, scales))),
            BlockCode::Mixed(mixed) => BlockWork::Mixed(Box::new(MixedWork::new(mixed, scales, modes))),
        }
    }

    fn may_jump(&mut self, allowed: bool) {
        match self {
            BlockWork::Assign(_) => {}
            BlockWork::Loop(newton) => newton.may_jump(allowed),
            BlockWork::Mixed(mixed) => mixed.continuous.iter_mut().for_each(|work| work.may_jump(allowed)),
        }
    }

    fn searched(&self) -> bool {
        match self {
            BlockWork::Assign(_) => false,
            BlockWork::Loop(newton) => newton.searched(),
            BlockWork::Mixed(mixed) => mixed.continuous.iter().any(BlockWork::searched),
        }
    }

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

fn run_loop(
    newton: &mut Newton,
    code: &LoopCode,
    setting: &BlockContext<'_>,
    values: &mut [f64],
) -> Result<(), BlockFailure> {
    newton.solve(code, setting.scales, values).map_err(|f| BlockFailure::Loop(Box::new(f)))?;
    check_finite(&code.inner, values)
}

fn check_finite(targets: &[AssignTarget], values: &[f64]) -> Result<(), BlockFailure> {
    match targets.iter().find(|t| !values[t.slot].is_finite()) {
        None => Ok(()),
        Some(target) => Err(BlockFailure::NonFinite(*target)),
    }
}

fn corrections(code: &AssignCode, modes: &CrossingModes) -> ModeCorrections {
    code.targets
        .iter()
        .filter_map(|t| match t.unknown {
            Unknown::Var(v) => Some((t.slot, modes.crossing(v)?)),
            Unknown::Der(_) => None,
        })
        .collect()
}

fn run_assign(code: &AssignCode, corrections: &ModeCorrections, setting: &BlockContext<'_>, values: &mut [f64]) {
    code.program.run(values);
    for &(slot, crossing) in corrections {
        values[slot] = setting.modes.correct(setting.system, crossing, values[slot], values);
    }
}

impl MixedWork {
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

    fn may_keep(&mut self, allowed: bool) {
        for work in &mut self.continuous {
            if let BlockWork::Loop(newton) = work {
                newton.may_keep(allowed);
            }
        }
    }

    /// Where no modes determine everything, what they leave open keeps its value, as long as the equations that are left
    /// over hold: two dry frictions hold one shaft, and each goes on with the load that it has.
    fn run(&mut self, code: &MixedCode, setting: &BlockContext<'_>, values: &mut [f64]) -> Result<(), BlockFailure> {
        let start = self.read(values);
        self.undetermined = None;
        self.keeps = false;
        let end = self.determine(code, setting, values, &start);
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

    /// With what the integrator saw cross; when that contradicts itself, without: the crossing was seen within the error
    /// of the solution but too early, and will be seen again.
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

    /// Fixed point first; when it circles, one change at a time; then combinations of modes, those next to the present
    /// one first.
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
                Ok(false) | Err(BlockFailure::Loop(_) | BlockFailure::NonFinite(_)) => {}
                Err(other) => return Err(other),
            }
        }
        self.write(start, values);
        self.combine(code, setting, values, start)
    }

    fn read(&self, values: &[f64]) -> Vec<f64> {
        self.slots.iter().map(|&s| values[s]).collect()
    }

    fn write(&self, discrete: &[f64], values: &mut [f64]) {
        for (&slot, v) in self.slots.iter().zip(discrete) {
            values[slot] = *v;
        }
    }

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

    fn run_discrete(&self, code: &MixedCode, setting: &BlockContext<'_>, values: &mut [f64]) {
        for (assign, corrections) in code.discrete.iter().zip(&self.corrections) {
            run_assign(assign, corrections, setting, values);
        }
    }

    /// True when the discrete values stayed; false when they circle.
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
            if seen.contains(&new) {
                return Ok(false);
            }
            seen.push(new);
        }
        Ok(false)
    }

    /// Tries every combination of a few modes.
    fn combine(
        &mut self,
        code: &MixedCode,
        setting: &BlockContext<'_>,
        values: &mut [f64],
        start: &[f64],
    ) -> Result<(), BlockFailure> {
        let relations: Vec<usize> =
            self.modes.iter().copied().filter(|&i| start[i] == 0.0 || start[i] == 1.0).collect();
        if relations.len() <= COMBINED {
            let mut combinations: Vec<u32> = (0..1 << relations.len()).collect();
            combinations.sort_by_key(|c: &u32| c.count_ones());
            let wanted = || combinations.iter().map(|&flips| flipped(start, &relations, flips));
            if wanted().any(|wanted| self.fits(code, setting, values, &wanted)) {
                return Ok(());
            }
            let mut modes = setting.modes.clone();
            for wanted in wanted() {
                relations.iter().for_each(|&i| self.hold(&mut modes, i, wanted[i]));
                if self.fits(code, &BlockContext { modes: &modes, ..*setting }, values, &wanted) {
                    return Ok(());
                }
            }
        }
        self.write(start, values);
        self.solve_continuous(code, setting, values)?;
        Err(BlockFailure::Mixed(self.targets.clone(), self.undetermined))
    }

    /// Lets a mode keep a value as long as what it compares differs by less than the error of the solution: where a current
    /// and a voltage vanish together, rounding decides on which side of 0 they lie, and may leave no side to any mode.
    fn hold(&self, modes: &mut CrossingModes, target: usize, value: f64) {
        if let Some(crossing) = modes.crossing(self.targets[target]) {
            modes.hold(crossing, value);
        }
    }

    /// Whether these modes reproduce themselves.
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

    /// Computes what depends on the modes, with the modes held.
    fn settle_others(&self, code: &MixedCode, setting: &BlockContext<'_>, values: &mut [f64], wanted: &[f64]) {
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

/// The start with some of its relations the other way round.
fn flipped(start: &[f64], relations: &[usize], flips: u32) -> Vec<f64> {
    let mut wanted = start.to_vec();
    for (bit, &i) in relations.iter().enumerate() {
        if flips >> bit & 1 == 1 {
            wanted[i] = 1.0 - start[i];
        }
    }
    wanted
}

/// The old values with one change: the first mode that wants to change, else the first of any.
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
