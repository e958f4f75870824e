//! What there is to tell about surfaces that share a place.

use super::read::text::shown;
use super::{MaterialId, Place, Report, Scene, Warning};
use std::collections::BTreeMap;

/// Pairs of surfaces that share an area, by their materials: the first is in front there, by
/// [the rule](crate::geometry) of the tree, and the second not to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coinciding {
    /// Of what is in front.
    pub front: MaterialId,
    /// Of what is behind.
    pub behind: MaterialId,
    /// How many pairs of primitives.
    pub pairs: usize,
}

/// Pairs of materials that are told of one by one where light is lost, and bytes of a line of the others.
const MOST: usize = 100;
const LINE: usize = 340;

impl Scene {
    /// Surfaces that share a place, by the materials of the one in front and the one behind. Pairs of
    /// one material that does not emit are not looked for: it makes no difference which is met.
    pub fn coinciding(&self) -> Vec<Coinciding> {
        let mut counts = BTreeMap::new();
        for pair in self.bvh.coincident().pairs() {
            *counts.entry(pair.map(|primitive| self.geometry.material(primitive))).or_insert(0) +=
                1;
        }
        let each =
            |([front, behind], pairs): ([u32; 2], usize)| Coinciding { front, behind, pairs };
        counts.into_iter().map(each).collect()
    }

    /// What only shows once the tree is built, into the report of the load: warnings where light is
    /// lost by it, a note where things stand on each other.
    pub fn report(&self, report: &mut Report) {
        let file =
            self.source.files.first().map_or_else(|| self.name.clone().into(), |f| f.path.clone());
        let warning = |text| Warning { place: Place { file: file.clone(), line: None }, text };
        let emits = |material: MaterialId| self.materials[material as usize].emits();
        let named = |material: MaterialId| {
            let also = if emits(material) { ", which emits," } else { "" };
            format!("`{}`{also}", shown(&self.materials[material as usize].name))
        };
        let pairs = |n: usize| if n == 1 { "1 pair".to_owned() } else { format!("{n} pairs") };
        let (lit, others): (Vec<_>, Vec<_>) =
            self.coinciding().into_iter().partition(|c| emits(c.front) || emits(c.behind));
        report.warnings.extend(lit.iter().take(MOST).map(|c| {
            warning(format!(
                "{} of surfaces share a place: {} is in front there, and {} is not seen",
                pairs(c.pairs),
                named(c.front),
                named(c.behind)
            ))
        }));
        if lit.len() > MOST {
            let more = lit.len() - MOST;
            report.warnings.push(warning(format!("{more} more pairs of materials share a place")));
        }
        if let Some((first, rest)) = others.split_first() {
            let told = |c: &Coinciding| {
                format!("{} before {} ({})", named(c.front), named(c.behind), pairs(c.pairs))
            };
            let mut text = told(first);
            for (i, next) in rest.iter().map(told).enumerate() {
                if text.len() + next.len() > LINE {
                    text += &format!(", and {} more pairs of materials", rest.len() - i);
                    break;
                }
                text = text + ", " + &next;
            }
            report.notes.push(format!(
                "surfaces share a place, and the first in the file is seen there: {text}"
            ));
        }
        if self.bvh.coincident().given_up {
            report.warnings.push(warning(
                "so many surfaces are in each other's boxes that not all were compared: where \
                 surfaces share a place, chance may decide which is seen"
                    .to_owned(),
            ));
        }
    }
}
