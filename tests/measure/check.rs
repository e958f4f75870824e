//! The proofs themselves: the right code passes all, and each mistake of the source report is found.

use burnish::brdf::{Erratum, Model, Normals, Roughness};
use burnish::measure::check::{Bound, CHANCE, EFFECT, Effort, Proof, Subject, finds, prove};

fn subject(model: Model, alpha: f64) -> Subject {
    Subject::new(model, Roughness::from_alpha(alpha).unwrap())
}

fn quick(subject: Subject) -> Vec<Proof> {
    prove(subject, Effort::Quick, 1).unwrap()
}

fn failing(proofs: &[Proof]) -> Vec<&Proof> {
    proofs.iter().filter(|p| !p.holds()).collect()
}

/// From the sharpest lobe to the dullest; between them where proofs begin to apply.
#[test]
fn the_right_code_passes_every_proof() {
    for model in Model::ALL {
        for alpha in [1e-4, 0.07, 1.0] {
            let proofs = quick(subject(model, alpha));
            assert!(proofs.len() >= 21, "{model:?} {alpha}: only {}", proofs.len());
            assert_eq!(failing(&proofs), Vec::<&Proof>::new(), "{model:?} at {alpha}");
        }
    }
}

#[test]
fn normals_drawn_from_the_whole_distribution_pass_as_well() {
    for model in [Model::Beckmann, Model::Ggx] {
        let subject = Subject { normals: Normals::Distribution, ..subject(model, 0.3) };
        assert_eq!(failing(&quick(subject)), Vec::<&Proof>::new(), "{model:?}");
    }
}

/// The mutation test of the proofs: every mistake that biases a picture makes the proof fail that
/// is named for it. One that is about no model in particular is tried with two.
#[test]
fn every_erratum_is_found_by_name() {
    let mut found = 0;
    for (i, erratum) in Erratum::ALL.into_iter().enumerate() {
        let models: Vec<_> = match erratum.model() {
            Some(model) => vec![model],
            None => vec![Model::ALL[i % 3], Model::ALL[(i + 1) % 3]],
        };
        for model in models {
            let proofs = quick(Subject { erratum: Some(erratum), ..subject(model, 0.1) });
            let names: Vec<_> = failing(&proofs).iter().map(|p| p.name).collect();
            match finds(erratum) {
                Some(name) => assert!(names.contains(&name), "{erratum:?} {model:?}: {names:?}"),
                // It costs noise alone, and nothing may say that it is a bias.
                None => assert!(!erratum.is_bias() && names.is_empty(), "{erratum:?}: {names:?}"),
            }
            found += usize::from(!names.is_empty());
        }
    }
    assert!(found > Erratum::ALL.len(), "{found}");
}

/// On a model that it is not about an erratum changes nothing, and no proof fails.
#[test]
fn an_erratum_of_another_model_is_no_erratum() {
    let wrong = Subject { erratum: Some(Erratum::GgxGSum), ..subject(Model::Phong, 0.3) };
    let right = quick(subject(Model::Phong, 0.3));
    let figures = |proofs: Vec<Proof>| proofs.iter().map(|p| p.figure).collect::<Vec<_>>();
    assert_eq!(figures(quick(wrong)), figures(right));
}

#[test]
fn figures_depend_on_no_number_of_threads() {
    let of = |threads| prove(subject(Model::Beckmann, 0.2), Effort::Quick, threads).unwrap();
    assert_eq!(of(1), of(3));
}

#[test]
fn what_is_not_a_number_is_not_proved() {
    let proof = |figure, bound| Proof { name: "", says: "", figure, bound };
    assert!(!proof(f64::NAN, Bound::AtMost(EFFECT)).holds());
    assert!(!proof(f64::NAN, Bound::AtLeast(CHANCE)).holds());
    assert!(proof(EFFECT, Bound::AtMost(EFFECT)).holds());
    assert!(!proof(0.0, Bound::AtLeast(CHANCE)).holds());
}
