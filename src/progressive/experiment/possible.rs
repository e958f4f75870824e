//! Whether an experiment's numbers are such as a render can have: who wrote the file is not known.

use super::Experiment;
use crate::film::Film;
use crate::math::sobol::REPLICATES;
use crate::progressive::Session;
use crate::progressive::plan::{self, Plan};

impl Experiment {
    /// What is in it that no render has, in words.
    pub(super) fn impossible(&self) -> Option<String> {
        let (recipe, uniform) = (&self.recipe, self.recipe.uniform);
        let in_order = self.spans.iter().all(|[a, b]| a < b)
            && self.spans.windows(2).all(|pair| pair[0][1] < pair[1][0]);
        let first = self.spans.first().map_or(recipe.first_pass, |span| span[0]);
        let last = self.spans.last().map_or(first, |span| span[1]);
        let length = |sum: u64, [a, b]: &[u64; 2]| sum.saturating_add(b.saturating_sub(*a));
        let count = self.spans.iter().fold(0, length);
        let single = uniform || self.spans.len() <= 1 && first == 0;
        if !in_order || count != recipe.passes || first != recipe.first_pass || !single {
            return Some(format!("its passes are {:?}", &self.spans[..self.spans.len().min(4)]));
        }
        let most = 2 * Session::MAX_PASSES;
        if last > most || !(-400..=400).contains(&self.quantum) {
            return Some(format!("it has pass {last} and a quantum of 2^{}", self.quantum));
        }
        let level = self.films.iter().all(|film| film.passes() == recipe.passes && film.is_whole());
        let about = self
            .films
            .iter()
            .all(|film| (recipe.passes..=recipe.passes + plan::UNIFORM).contains(&film.passes()));
        if level != self.is_whole() || !about || !level && self.spans.len() > 1 {
            return Some("its tiles have other passes than its recipe".to_owned());
        }
        let counted = self.films.iter().all(|film| {
            let dealt = self.dealt(film.passes());
            // What was planned is looked at below.
            film.planned_at().is_some()
                || film.is_whole() && (0..film.cells()).all(|cell| film.counts(cell) == dealt)
        });
        if !counted || uniform && self.films.iter().any(Film::is_uneven) {
            return Some("its numbers of samples are not those of its passes".to_owned());
        }
        self.unplanned()
    }

    /// Samples of each replicate where passes are assigned in turn, in a tile of `passes` passes.
    fn dealt(&self, passes: u64) -> [u64; REPLICATES] {
        let before = |end: u64| {
            let each = REPLICATES as u64;
            std::array::from_fn(|r| end / each + u64::from(end % each > r as u64))
        };
        let mut counts = [0; REPLICATES];
        // Tiles that are ahead have more of the only span.
        let ahead = passes - self.recipe.passes;
        let spans = self.spans.iter().copied();
        let spans = spans.chain(self.spans.is_empty().then_some([self.recipe.first_pass; 2]));
        for [from, to] in spans {
            let (low, high): ([u64; REPLICATES], [u64; REPLICATES]) =
                (before(from), before(to + ahead));
            (0..REPLICATES).for_each(|r| counts[r] += high[r] - low[r]);
        }
        counts
    }

    /// What is not as the plan in force has it.
    fn unplanned(&self) -> Option<String> {
        const MOST: u64 = 1 << 42;
        let wrong = || Some("its numbers of samples are not those of its plan".to_owned());
        let (start, made) =
            (plan::start_of_plan(self.recipe.passes), self.films.first()?.planned_at());
        // A plan is made when the first pass is traced that it is for.
        let earlier = start > plan::UNIFORM && made == Some(start / 4);
        let due = made == Some(start) && start > 0;
        let ahead =
            self.films.iter().any(|film| film.passes() > self.recipe.passes || !film.is_whole());
        let boundary = self.recipe.passes == start && !ahead;
        if made.is_none() {
            let none = |film: &Film| {
                let cells = 0..film.cells();
                let mut spreads = cells.flat_map(|cell| film.spreads(cell));
                !film.is_uneven() && spreads.all(Vec::is_empty)
            };
            let unplanned = self.recipe.uniform || start == 0 || boundary && start == plan::UNIFORM;
            return if self.films.iter().all(none) && unplanned { None } else { wrong() };
        }
        let made = made?;
        if self.recipe.uniform || !(due || earlier && boundary) {
            return wrong();
        }
        for film in &self.films {
            let fits = |cell: usize| {
                let (counts, before) = (film.counts(cell), film.planned(cell));
                counts[0] == counts[1]
                    && counts[2] == counts[3]
                    && counts.iter().all(|&n| n <= MOST)
                    && (0..2).all(|half| before[half] <= counts[2 * half])
                    && (0..2).all(|half| {
                        let noted = (0..20).filter(|k| 4u64 << (2 * k) <= counts[2 * half]).count();
                        film.spreads(cell)[half].len() == noted
                    })
            };
            if film.planned_at() != Some(made) || !(0..film.cells()).all(fits) {
                return wrong();
            }
        }
        let plan = Plan::new(self.grid(), &self.films, made);
        for (tile, film) in self.films.iter().enumerate() {
            for cell in 0..film.cells() {
                let counts = film.counts(cell);
                // Of a pass that is not whole there may be any number.
                let end = film.passes() + u64::from(!film.is_whole());
                let [from, to] = [film.passes(), end].map(|passes| plan.done(tile, cell, passes));
                if (0..2).any(|half| !(from[half]..=to[half]).contains(&counts[2 * half])) {
                    return wrong();
                }
            }
        }
        None
    }
}
