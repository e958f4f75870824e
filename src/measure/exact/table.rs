//! The table of answers, and what is asked of each scene.

use super::ExactError;
use super::group::Group;
use super::known::Known;
use super::stage::{ExactStage, Where};
use crate::math::simd::Isa;
use crate::measure::site::Somewhere;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::Arc;

/// One line a scene: group, parameters, answers by quantity, bound of their error, method.
const TABLE: &str = include_str!("../../../assets/exact_scenes.json");

/// One question with its answer: a scene, and where to look.
#[derive(Clone, Debug)]
pub struct Case {
    /// The scene: group and number.
    pub id: String,
    /// Which of the scene's radiances.
    pub quantity: String,
    /// What the scene is about.
    pub group: &'static str,
    /// The radiance, or mean radiance, that is known.
    pub expected: f64,
    /// Bound of the absolute error of `expected`.
    pub error: f64,
    /// How `expected` was found.
    pub method: String,
    pub(super) scene: Arc<Group>,
    pub(super) at: Where,
}

/// What this program cannot express, and why.
#[derive(Clone, Debug)]
pub struct LeftOut {
    /// The scene.
    pub id: String,
    /// Which of its radiances.
    pub quantity: String,
    /// Why not.
    pub reason: String,
}

/// Every scene of the table, asked or left out.
#[derive(Clone, Debug, Default)]
pub struct CaseTable {
    /// What can be asked, in the order of the table.
    pub cases: Vec<Case>,
    /// What cannot.
    pub left_out: Vec<LeftOut>,
    /// Number of scenes: each has cases, or is left out, or both in parts.
    pub scenes: usize,
}

/// All scenes. Fails only if the table, which is part of the program, is broken; a test holds that
/// it is not.
pub fn all() -> Result<CaseTable, ExactError> {
    let rows: Vec<CaseRow> = serde_json::from_str(TABLE)?;
    let mut table = CaseTable { scenes: rows.len(), ..CaseTable::default() };
    for row in rows {
        let scene = Arc::new(row.scene);
        let wanted = row.expected.into_iter().filter(|(q, _)| !row.left_out.contains_key(q));
        table.cases.extend(wanted.map(|(quantity, expected)| Case {
            id: row.id.clone(),
            quantity,
            group: scene.name(),
            expected,
            error: row.error,
            method: row.method.clone(),
            scene: scene.clone(),
            at: Where { place: Somewhere::HERE, isa: Isa::detect() },
        }));
        let id = &row.id;
        table.left_out.extend(row.left_out.into_iter().map(|(quantity, reason)| LeftOut {
            id: id.clone(),
            quantity,
            reason,
        }));
    }
    Ok(table)
}

impl Case {
    /// The scene and where it is seen from.
    pub(super) fn stage(&self) -> Result<ExactStage, ExactError> {
        self.scene.stage(&self.quantity, self.at)
    }

    /// The scene's parameters, where it stands and what it runs on.
    pub fn description(&self) -> String {
        let Where { place, isa } = self.at;
        format!("{:?} at {place:?} on {}", self.scene, isa.name())
    }

    /// The answer computed from the scene's parameters; `None` where there is none.
    pub fn known(&self) -> Result<Option<Known>, ExactError> {
        self.scene.known(&self.quantity)
    }
}

#[derive(Debug, Deserialize)]
struct CaseRow {
    id: String,
    #[serde(flatten)]
    scene: Group,
    expected: BTreeMap<String, f64>,
    error: f64,
    method: String,
    #[serde(default)]
    left_out: BTreeMap<String, String>,
}
