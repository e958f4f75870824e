//! The list of states that undo and redo go through.

/// Seconds within which changes may be one step.
const GESTURE: f64 = 0.6;
/// Steps that are kept.
const MOST: usize = 200;

/// Something that a history is made of.
pub(crate) trait State: Clone {
    /// The parts that are dragged, scrolled or nudged, so that many small changes make one step.
    /// A change of any other part, or of several, is a step by itself.
    const FLOWING: u32;

    /// The parts in which it differs from another, a bit each; 0 if in none.
    fn differs(&self, from: &Self) -> u32;
}

/// The present state, those before it, and those after it that were taken back.
pub(crate) struct History<T> {
    past: Vec<T>,
    present: T,
    future: Vec<T>,
    last: Option<Change>,
}

/// The change that led to the present.
struct Change {
    parts: u32,
    time: f64,
    /// The pointer has been down ever since.
    held: bool,
}

impl<T: State> History<T> {
    pub(crate) fn new(present: T) -> History<T> {
        History { past: Vec::new(), present, future: Vec::new(), last: None }
    }

    /// Takes note of how things are at `now` seconds, and of whether the pointer is `down`: to be
    /// called with every frame. A drag is one step however long it takes.
    pub(crate) fn note(&mut self, state: &T, now: f64, down: bool) {
        if let Some(last) = &mut self.last {
            last.held &= down;
        }
        let parts = state.differs(&self.present);
        if parts == 0 {
            return;
        }
        let flows = parts & T::FLOWING == parts && parts.is_power_of_two();
        let goes_on = |last: &Change| last.held || now - last.time <= GESTURE;
        let same = self.last.as_ref().is_some_and(|c| flows && c.parts == parts && goes_on(c));
        let before = std::mem::replace(&mut self.present, state.clone());
        if !same {
            if self.past.len() == MOST {
                self.past.remove(0);
            }
            self.past.push(before);
        }
        self.future.clear();
        self.last = Some(Change { parts, time: now, held: down });
    }

    /// Goes one step back, and returns the state that is there.
    pub(crate) fn undo(&mut self) -> Option<&T> {
        let there = self.past.pop()?;
        self.future.push(std::mem::replace(&mut self.present, there));
        self.last = None;
        Some(&self.present)
    }

    /// Takes back the last undo.
    pub(crate) fn redo(&mut self) -> Option<&T> {
        let there = self.future.pop()?;
        self.past.push(std::mem::replace(&mut self.present, there));
        self.last = None;
        Some(&self.present)
    }

    pub(crate) fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    pub(crate) fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slider and a switch.
    impl State for (i32, bool) {
        const FLOWING: u32 = 1;
        fn differs(&self, from: &Self) -> u32 {
            u32::from(self.0 != from.0) | u32::from(self.1 != from.1) << 1
        }
    }

    /// The states that undo goes through, the present one first.
    fn steps(history: &mut History<(i32, bool)>) -> Vec<(i32, bool)> {
        let mut all = vec![history.present];
        while let Some(before) = history.undo() {
            all.push(*before);
        }
        all
    }

    #[test]
    fn a_drag_is_one_step_and_so_is_a_quick_row_of_nudges() {
        let mut history = History::new((0, false));
        for (i, time) in [1.0, 2.0, 5.0].into_iter().enumerate() {
            history.note(&(i as i32 + 1, false), time, true);
            history.note(&(i as i32 + 1, false), time + 0.5, true);
        }
        history.note(&(3, false), 5.6, false);
        for i in 0..4 {
            history.note(&(i + 10, false), 7.0 + 0.5 * f64::from(i), false);
        }
        assert_eq!(steps(&mut history), [(13, false), (3, false), (0, false)]);
    }

    #[test]
    fn a_pause_another_part_and_a_switch_begin_a_new_step() {
        let mut history = History::new((0, false));
        history.note(&(1, false), 1.0, false);
        history.note(&(2, false), 1.7, false);
        history.note(&(2, true), 1.8, false);
        history.note(&(2, false), 1.9, false);
        history.note(&(3, true), 2.0, false);
        let expected = [(3, true), (2, false), (2, true), (2, false), (1, false), (0, false)];
        assert_eq!(steps(&mut history), expected);
    }

    #[test]
    fn redo_goes_back_until_something_else_is_done() {
        let mut history = History::new((0, false));
        for i in 1..=3 {
            history.note(&(i, false), f64::from(i), false);
        }
        assert!(history.can_undo() && !history.can_redo());
        assert_eq!(
            (history.undo().copied(), history.undo().copied()),
            (Some((2, false)), Some((1, false)))
        );
        // The states that undo brings back are no changes.
        history.note(&(1, false), 4.0, false);
        assert_eq!(history.redo(), Some(&(2, false)));
        history.note(&(2, false), 4.0, false);
        // A change right after is a step of its own, and ends what could be redone.
        history.note(&(7, false), 4.1, false);
        assert!(!history.can_redo() && history.redo().is_none());
        assert_eq!(steps(&mut history), [(7, false), (2, false), (1, false), (0, false)]);
    }

    #[test]
    fn the_oldest_steps_are_forgotten() {
        let mut history = History::new((0, false));
        for i in 1..=MOST as i32 + 5 {
            history.note(&(i, false), f64::from(i), false);
        }
        let all = steps(&mut history);
        assert_eq!((all.len(), all.last()), (MOST + 1, Some(&(5, false))));
    }
}
