//! `burnish check`: the proofs of the models, as a table.

mod random;
mod whole;

use super::numbers::significant;
use super::{Failure, print, say, values};
use burnish::brdf::{Erratum, Model, Normals, Roughness};
use burnish::measure::check::{Bound, Effort, Proof, Subject, prove};
use burnish::measure::energy::LobeEnergy;

/// Proves the models: each against its textbook, its sampler and the tracer against it.
///
/// Exit code 1 if a proof fails.
#[derive(Debug, clap::Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "Examples:
  burnish check                                     all three models at alpha 0.1
  burnish check --model beckmann --alpha 0.02
  burnish check --full                              everything; takes minutes
  burnish check --scene 17                          a scene drawn at random, again
  burnish check --erratum ggx-g-sum                 which proof finds that mistake of the source report?")]
pub(super) struct Args {
    /// Which BRDF; without it all of them, or the one that the erratum is about.
    #[arg(long, value_parser = values::model())]
    model: Option<Model>,
    /// Roughness alpha, 0.0001 to 1 [default: 0.1]
    #[arg(long, value_name = "A", value_parser = values::alpha)]
    alpha: Option<Roughness>,
    /// Phong exponent a_p, 0 to 199999998; alpha = sqrt(2 / (a_p + 2)).
    #[arg(long, value_name = "N", conflicts_with = "alpha", value_parser = values::exponent)]
    exponent: Option<Roughness>,
    /// Many times the samples, both ways of drawing normals, and without --alpha or --exponent all
    /// roughnesses.
    #[arg(long)]
    full: bool,
    /// Instead, the scenes drawn at random of these seeds, A or A..B: the engine against the
    /// reference tracer.
    #[arg(long, value_name = "SEEDS", value_parser = random::seeds)]
    #[arg(conflicts_with_all = ["model", "alpha", "exponent", "full", "erratum"])]
    scene: Option<std::ops::Range<u64>>,
    /// Instead, the scenes of known answer drawn at random of these seeds, A or A..B.
    #[arg(long, value_name = "SEEDS", value_parser = random::seeds)]
    #[arg(conflicts_with_all = ["model", "alpha", "exponent", "full", "erratum", "scene"])]
    known: Option<std::ops::Range<u64>>,
    /// A mistake made on purpose: a proof is to find it.
    #[arg(long, value_name = "NAME", value_parser = values::erratum())]
    erratum: Option<Erratum>,
    /// Worker threads; 0 is one a core. No figure depends on it.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = values::threads())]
    threads: usize,
}

/// What `--full` tries.
const ALPHAS: [f64; 10] = [1e-4, 3e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.35, 0.6, 1.0];
/// What is tried otherwise.
const ALPHA: f64 = 0.1;

/// Proves and prints.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(seeds) = &args.scene {
        return verdict(random::some(seeds.clone(), true)?);
    }
    if let Some(seeds) = &args.known {
        return verdict(whole::drawn_scenes(seeds.clone(), true)?);
    }
    let roughnesses = args.roughnesses()?;
    let mut failures = 0;
    for model in Model::ALL.into_iter().filter(|m| args.means(*m)) {
        let mut table = Table::default();
        for (i, &roughness) in roughnesses.iter().enumerate() {
            if args.full {
                let (at, of) = (i + 1, roughnesses.len());
                say(format_args!("{} at alpha {}: {at} of {of}", model.title(), roughness.alpha()));
            }
            for &normals in args.normals(model) {
                let subject = Subject { model, roughness, normals, erratum: args.erratum };
                let effort = if args.full { Effort::Full } else { Effort::Quick };
                table.add(subject, &prove(subject, effort, args.threads).map_err(Failure::new)?);
            }
        }
        failures += table.print(model, &roughnesses)?;
    }
    if args.full && args.erratum.is_none() {
        failures +=
            whole::exact_scenes()? + whole::drawn_scenes(whole::DRAWN, false)? + random::all()?;
        failures += whole::error_bar(args.threads)?;
    }
    verdict(failures)
}

fn verdict(failures: usize) -> Result<(), Failure> {
    match failures {
        0 => Ok(()),
        1 => Err(Failure::new("1 proof fails")),
        n => Err(Failure::new(format_args!("{n} proofs fail"))),
    }
}

impl Args {
    fn means(&self, model: Model) -> bool {
        self.model.unwrap_or(model) == model && self.erratum.is_none_or(|e| e.concerns(model))
    }

    fn roughnesses(&self) -> Result<Vec<Roughness>, Failure> {
        if let Some(roughness) = self.alpha.or(self.exponent) {
            return Ok(vec![roughness]);
        }
        let alphas = if self.full { &ALPHAS[..] } else { &[ALPHA] };
        let all: Result<_, _> = alphas.iter().map(|&a| Roughness::from_alpha(a)).collect();
        all.map_err(Failure::new)
    }

    fn normals(&self, model: Model) -> &'static [Normals] {
        // Phong knows one way only.
        if self.full && model != Model::Phong { &Normals::ALL } else { &[Normals::Visible] }
    }
}

/// Of each proof the worst case met.
#[derive(Default)]
struct Table {
    rows: Vec<(Proof, Subject)>,
}

impl Table {
    fn add(&mut self, subject: Subject, proofs: &[Proof]) {
        for &proof in proofs {
            match self.rows.iter_mut().find(|(row, _)| row.name == proof.name) {
                Some(row) if worse(&proof, &row.0) => *row = (proof, subject),
                Some(_) => {}
                None => self.rows.push((proof, subject)),
            }
        }
    }

    /// Returns how many fail.
    fn print(&self, model: Model, roughnesses: &[Roughness]) -> Result<usize, Failure> {
        let title = model.title();
        let place = roughnesses.len() > 1;
        match roughnesses {
            [r] => print(format_args!(
                "{title} at alpha {} (a_p {})",
                significant(r.alpha(), 4),
                significant(r.exponent(), 4)
            ))?,
            _ => print(format_args!("{title}, the worst of {} roughnesses", roughnesses.len()))?,
        }
        let at = if place { format!("{:<9}", "at alpha") } else { String::new() };
        print(format_args!(
            "  {:<27}{:>9}  {:<11}{:<8}{at}{}",
            "proof", "figure", "bound", "", "claim"
        ))?;
        for (proof, subject) in &self.rows {
            let bound = match proof.bound {
                Bound::AtMost(most) => format!("<= {}", digits(most)),
                Bound::AtLeast(least) => format!(">= {}", digits(least)),
            };
            let verdict = if proof.holds() { "holds" } else { "FAILS" };
            let at =
                if place { format!("{:<9}", subject.roughness.alpha()) } else { String::new() };
            print(format_args!(
                "  {:<27}{:>9}  {bound:<11}{verdict:<8}{at}{}",
                proof.name,
                digits(proof.figure),
                proof.says
            ))?;
        }
        if let [roughness] = roughnesses {
            let energy = LobeEnergy::of(model, *roughness);
            print(format_args!(
                "  With F = 1 the lobe keeps {} % of the light on average, {} % at the angle where it \
                 keeps most.",
                significant(100.0 * (1.0 - energy.loss()), 3),
                significant(100.0 * energy.most(), 3)
            ))?;
        }
        print("")?;
        Ok(self.rows.iter().filter(|(proof, _)| !proof.holds()).count())
    }
}

/// Whether `a` is nearer to failing than `b`, or further beyond.
fn worse(a: &Proof, b: &Proof) -> bool {
    a.figure.is_nan()
        || match a.bound {
            Bound::AtMost(_) => a.figure > b.figure,
            Bound::AtLeast(_) => a.figure < b.figure,
        }
}

/// A figure, a whole number as one.
fn digits(figure: f64) -> String {
    if figure.fract() == 0.0 { significant(figure, 1) } else { significant(figure, 2) }
}
