//! Tracing a contact sheet, cell by cell.

use super::Sheet;
use super::search::Search;
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
    /// The picture with its error, passes and seconds. Of a cell that was easy enough to need fewer passes
    /// than the error of a picture is first looked at with, it is the error that a finer picture tells; see
    /// [`ErrorEstimate::of_coarser`](crate::film::ErrorEstimate::of_coarser).
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
        let mut further = |snapshot: &Snapshot| {
            let more = rule.next(snapshot.passes, snapshot.error.as_ref());
            more.map(|passes| passes.min(most)).filter(|_| snapshot.passes < most)
        };
        let first = StopRule::FIRST.min(most);
        let (finest, stopped) =
            trace(&params, threads, first, &mut further, &mut |s| tell(s, false))?;
        let reached = rule.next(finest.passes, finest.error.as_ref()).is_none();
        let stopped = stopped && !reached && finest.passes < most;
        let mut cell = TracedCell { snapshot: finest, reached, stopped };
        if reached {
            self.thin_out(&mut cell, &params, threads, &mut || tell(None, false))?;
        }
        Ok(cell)
    }

    /// Gives a cell fewer passes if its error is less than that of the others needs to be: it is traced
    /// again to fewer, and the picture that it has serves to know the error of that one. `stops` returns
    /// whether the sheet is to stop.
    fn thin_out(
        &self,
        cell: &mut TracedCell,
        params: &Params,
        threads: usize,
        stops: &mut dyn FnMut() -> bool,
    ) -> Result<(), ParamsError> {
        let Some(error) = cell.snapshot.error else { return Ok(()) };
        let finest = cell.snapshot.mean().pixels;
        let mut search = Search::new(self.error, cell.snapshot.passes, &error);
        while let Some(passes) = search.next() {
            let (mut snapshot, stopped) =
                trace(params, threads, passes, &mut |_| None, &mut |_| stops())?;
            if stopped {
                break;
            }
            let error = error.of_coarser(&snapshot.mean().pixels, &finest);
            snapshot.error = Some(error);
            if search.note(passes, &error) {
                cell.snapshot = snapshot;
            }
        }
        Ok(())
    }
}

/// Traces to `passes` and as many more as `further` says then, until it says none, and returns the picture and
/// whether it was stopped; `watch` returns whether it is to.
fn trace(
    params: &Params,
    threads: usize,
    passes: u64,
    further: &mut dyn FnMut(&Snapshot) -> Option<u64>,
    watch: &mut dyn FnMut(Option<&Snapshot>) -> bool,
) -> Result<(Snapshot, bool), ParamsError> {
    let options = Options::headless(threads);
    let session = Session::with_options(params.clone(), passes, options, || {})?;
    let mut stops = false;
    loop {
        let snapshot = next(&session, threads)?;
        if let Some(snapshot) = snapshot.as_ref().filter(|s| s.state != State::Running) {
            match further(snapshot) {
                Some(passes) if !stops => session.set_limit(passes),
                _ => return Ok((snapshot.clone(), stops)),
            }
        }
        if watch(snapshot.as_ref()) && !stops {
            stops = true;
            session.pause();
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
        sheet.error = 0.1;
        sheet.most_passes = 4096;
        sheet
    }

    /// By their own figures, and by pictures of eight times as many passes, whose own errors are taken off.
    #[test]
    fn all_cells_have_the_same_error_and_the_bits_of_a_render() {
        let mut sheet = sheet();
        // Errors of fewer pixels are those of single samples, and do not fall with every pass.
        sheet.params.size = [32, 24];
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
        let mut truths = Vec::new();
        for (i, cell) in traced.cells.iter().enumerate() {
            let cell = cell.as_ref().unwrap();
            let (snapshot, passes) = (&cell.snapshot, cell.snapshot.passes);
            let error = snapshot.error.unwrap().relative;
            assert!(cell.reached && error.interval.high <= sheet.error, "{passes}: {error:?}");
            // What a pass more or less makes is more than that where there are few.
            let near = Search::NEAR.min((1.0 - 1.0 / passes as f64).powi(2));
            assert!(error.interval.high >= near * sheet.error, "{passes}: {error:?}");
            // Traced alone, by another number of threads.
            let alone = render(sheet.cell(i).unwrap(), passes, 1).unwrap();
            assert!(alone.mean() == snapshot.mean(), "cell {i}");
            let other = Params { seed: 4, ..sheet.cell(i).unwrap() };
            let truth = render(other, 8 * passes, 2).unwrap();
            let known = truth.error.unwrap();
            let apart = known.of_coarser(&alone.mean().pixels, &truth.mean().pixels);
            truths.push((passes, apart.relative.value / error.value));
        }
        // One cell is easier than the others by far.
        assert!(truths.iter().any(|t| t.0 < 16) && truths.iter().any(|t| t.0 > 64), "{truths:?}");
        // The errors of single pictures: of the figures each is right but for its own noise.
        assert!(truths.iter().all(|t| (0.7..1.4).contains(&t.1)), "{truths:?}");
    }

    /// Pictures of few passes, judged by one of 64: the truth, which one of very many stands for, is within the
    /// limits of 95 % of them (of 90: 4 sigma are 9 %), which are near.
    #[test]
    fn a_finer_picture_tells_the_error_of_a_coarser_one() {
        let params = sheet().cell(3).unwrap();
        let truth = render(Params { seed: 999, ..params.clone() }, 2048, 2).unwrap();
        let (known, truth) = (truth.error.unwrap(), truth.mean().pixels);
        let (mut held, mut pictures) = (0, 0);
        for seed in 0..30 {
            let params = Params { seed, ..params.clone() };
            let finer = render(params.clone(), 64, 2).unwrap();
            let (error, finer) = (finer.error.unwrap(), finer.mean().pixels);
            for passes in [3, 8, 31] {
                let coarser = render(params.clone(), passes, 2).unwrap().mean().pixels;
                let told = error.of_coarser(&coarser, &finer).relative;
                let true_error = known.of_coarser(&coarser, &truth).relative.value;
                held += told.interval.contains(true_error) as u32;
                pictures += 1;
                assert!(told.interval.high < 2.0 * told.value, "{passes}: {told:?}");
            }
        }
        assert!(held * 100 >= pictures * 86, "{held} of {pictures}");
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
