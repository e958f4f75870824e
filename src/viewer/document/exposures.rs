//! The exposure of each scene: one that is come back to is as bright as it was left.

use crate::viewer::jobs::load::Source;

/// Scenes that are remembered.
const MOST: usize = 64;

/// Exposures in stops, of the scenes that were left, those left last at the end.
#[derive(Debug, Default)]
pub(crate) struct Exposures(Vec<(Source, f32)>);

impl Exposures {
    /// Takes note of a scene's exposure.
    pub(crate) fn note(&mut self, source: &Source, stops: f32) {
        self.0.retain(|(of, _)| of != source);
        if self.0.len() == MOST {
            self.0.remove(0);
        }
        self.0.push((source.clone(), stops));
    }

    /// The exposure of a scene; 0 for one not seen yet.
    pub(crate) fn of(&self, source: &Source) -> f32 {
        self.0.iter().find(|(of, _)| of == source).map_or(0.0, |(_, stops)| *stops)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_scene_has_its_own_and_the_oldest_go() {
        let source = |i: usize| Source::File(format!("{i}.scn").into());
        let mut exposures = Exposures::default();
        (0..MOST + 3).for_each(|i| exposures.note(&source(i), i as f32 + 0.5));
        exposures.note(&source(7), -1.0);
        assert_eq!(exposures.of(&source(7)), -1.0);
        assert_eq!(exposures.of(&source(MOST + 2)), MOST as f32 + 2.5);
        assert_eq!([exposures.of(&source(0)), exposures.of(&source(1000))], [0.0; 2]);
        assert_eq!(exposures.0.len(), MOST);
    }
}
