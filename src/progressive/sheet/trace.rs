//! Tracing a contact sheet, cell by cell.

use super::Sheet;
use crate::progressive::{Options, Params, ParamsError, Session, Snapshot, State, StopRule};
use std::time::Duration;

/// How long it may take until an end that is wished for is noticed.
const TICK: Duration = Duration::from_millis(50);

/// How far a sheet is.
#[derive(Clone, Copy, Debug)]
pub struct SheetProgress<'a> {
    /// The cell that is traced, row by row from 0.
    pub cell: usize,
    /// Its newest picture, if there is a new one.
    pub snapshot: Option<&'a Snapshot>,
    /// Whether that is its last.
    pub is_done: bool,
}

/// A cell with its picture.
#[derive(Clone, Debug)]
pub struct TracedCell {
    /// The picture with its error, passes and seconds.
    pub snapshot: Snapshot,
    /// Whether its error is what was wished for. If not, it has all of the passes that it may have, or was
    /// stopped.
    pub reached: bool,
    /// Whether it was stopped before either.
    pub stopped: bool,
}

/// A sheet that was traced, or the part of it that was done when it was stopped.
#[derive(Clone, Debug)]
pub struct TracedSheet {
    /// What was to be traced.
    pub sheet: Sheet,
    /// Its cells, row by row; nothing where a cell was not begun.
    pub cells: Vec<Option<TracedCell>>,
}

impl TracedSheet {
    /// Number of cells that were not stopped.
    pub fn done(&self) -> usize {
        self.cells.iter().flatten().filter(|cell| !cell.stopped).count()
    }
}

impl Sheet {
    /// Traces all cells, one after the other, by `threads` workers (0 for one a core). `watch` is called at
    /// least every twentieth of a second and stops the sheet by returning false: the cell that is being
    /// traced then is kept if every pixel has a sample, and those after it are not begun.
    ///
    /// Blocks until done. Each cell has the bits that a render of its parameters and passes has.
    pub fn trace(
        &self,
        threads: usize,
        mut watch: impl FnMut(SheetProgress) -> bool,
    ) -> Result<TracedSheet, ParamsError> {
        let mut cells = vec![None; self.len()];
        let mut stop = false;
        for (cell, place) in cells.iter_mut().enumerate() {
            let Some(params) = self.cell(cell).filter(|_| !stop) else { break };
            let mut tell = |snapshot: Option<&Snapshot>, is_done| {
                stop |= !watch(SheetProgress { cell, snapshot, is_done });
                stop
            };
            let traced = self.trace_one(params, threads, &mut tell)?;
            if traced.snapshot.passes > 0 {
                tell(Some(&traced.snapshot), true);
                *place = Some(traced);
            }
        }
        Ok(TracedSheet { sheet: self.clone(), cells })
    }

    /// Traces a cell; `tell` returns whether the sheet is to stop.
    fn trace_one(
        &self,
        params: Params,
        threads: usize,
        tell: &mut dyn FnMut(Option<&Snapshot>, bool) -> bool,
    ) -> Result<TracedCell, ParamsError> {
        let (rule, most) = (self.rule(), self.most_passes.clamp(1, Session::MAX_PASSES));
        let options = Options::headless(threads);
        let session = Session::with_options(params, StopRule::FIRST.min(most), options, || {})?;
        let mut stops = false;
        loop {
            let snapshot = next(&session, threads)?;
            if let Some(snapshot) = snapshot.as_ref().filter(|s| s.state != State::Running) {
                let further = rule.next(snapshot.passes, snapshot.error.as_ref());
                let reached = further.is_none();
                match further.filter(|_| snapshot.passes < most) {
                    Some(passes) if !stops => session.set_limit(passes.min(most)),
                    left => {
                        let stopped = left.is_some();
                        return Ok(TracedCell { snapshot: snapshot.clone(), reached, stopped });
                    }
                }
            }
            if tell(snapshot.as_ref(), false) && !stops {
                stops = true;
                session.pause();
            }
        }
    }
}

/// The next snapshot, if one comes in time.
fn next(session: &Session, threads: usize) -> Result<Option<Snapshot>, ParamsError> {
    let failed = |reason| Err(ParamsError::Threads { threads, reason });
    match session.snapshots().recv_timeout(TICK) {
        Ok(Snapshot { state: State::Failed(reason), .. }) => failed(reason),
        Ok(snapshot) => Ok(Some(snapshot)),
        Err(e) if e.is_timeout() => Ok(None),
        Err(_) => failed("the workers stopped".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::{Model, Roughness};
    use crate::progressive::render;
    use crate::scene::builtin::default_scene;
    use std::sync::Arc;

    /// Two models by two roughnesses of the default scene, small.
    fn sheet() -> Sheet {
        let scene = Arc::new(default_scene().unwrap().0.build());
        let mut sheet = Sheet::new(Params { size: [24, 18], seed: 3, ..Params::new(scene) });
        sheet.models = vec![Model::Phong, Model::Ggx];
        sheet.roughnesses =
            [0.1, 0.5].into_iter().filter_map(|a| Roughness::from_alpha(a).ok()).collect();
        sheet.error = 0.06;
        sheet.most_passes = 512;
        sheet
    }

    #[test]
    fn every_cell_has_the_error_or_all_its_passes_and_the_bits_of_a_render() {
        let sheet = sheet();
        let mut seen = Vec::new();
        let traced = sheet
            .trace(2, |at| {
                seen.push((at.cell, at.is_done));
                true
            })
            .unwrap();
        assert_eq!((traced.done(), traced.cells.len()), (4, 4));
        assert_eq!(seen.iter().filter(|(_, done)| *done).count(), 4);
        assert!(seen.is_sorted_by_key(|(cell, _)| *cell));
        let mut reached = 0;
        for (i, cell) in traced.cells.iter().enumerate() {
            let cell = cell.as_ref().unwrap();
            let (snapshot, passes) = (&cell.snapshot, cell.snapshot.passes);
            let error = snapshot.error.unwrap().relative;
            if cell.reached {
                reached += 1;
                assert!(error.value <= sheet.error && error.interval.high <= sheet.error);
            } else {
                assert_eq!(passes, sheet.most_passes);
            }
            // Traced alone, by another number of threads.
            let alone = render(sheet.cell(i).unwrap(), passes, 1).unwrap();
            assert!(alone.mean() == snapshot.mean(), "cell {i}");
        }
        assert!(reached > 0);
    }

    /// An error that is out of reach ends at the most passes, which may be fewer than the first look.
    #[test]
    fn no_cell_has_more_passes_than_it_may() {
        for most in [5, 100] {
            let mut sheet = sheet();
            sheet.models.truncate(1);
            sheet.roughnesses.truncate(1);
            (sheet.error, sheet.most_passes) = (1e-6, most);
            let traced = sheet.trace(2, |_| true).unwrap();
            let cell = traced.cells[0].as_ref().unwrap();
            assert_eq!((cell.snapshot.passes, cell.reached, cell.stopped), (most, false, false));
        }
    }

    #[test]
    fn a_stop_keeps_what_is_done_and_begins_nothing() {
        let mut sheet = sheet();
        sheet.error = 1e-6;
        let mut last = 0;
        let traced = sheet.trace(2, |at| {
            last = at.cell;
            at.cell == 0
        });
        let traced = traced.unwrap();
        assert_eq!(last, 1);
        assert!(traced.cells[0].as_ref().is_some_and(|cell| !cell.stopped));
        assert!(traced.cells[2..].iter().all(Option::is_none));
        assert!(traced.cells[1].as_ref().is_none_or(|cell| cell.stopped && !cell.reached));
        assert_eq!(traced.done(), 1);
    }
}
