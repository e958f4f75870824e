//! The whole renderer against scenes whose answer is known.

use burnish::measure::exact::{Budget, Outcome, run_all};

fn line(o: &Outcome) -> String {
    let name = format!("{} {}", o.case.id, o.case.quantity);
    format!(
        "{name:24} {:20} {:12.6e} {:12.6e} +- {:8.1e} {:6.2} {:9.1e} {:>10} {:?}",
        o.case.group,
        o.case.expected,
        o.mean,
        o.standard_error,
        o.sigmas,
        o.relative_error,
        o.counts.paths,
        o.verdict,
    )
}

#[test]
#[ignore]
fn full() {
    let budget = if std::env::var("QUICK").is_ok() { Budget::QUICK } else { Budget::FULL };
    let start = std::time::Instant::now();
    let mut last = 0.0;
    let s = run_all(budget, &mut |o| {
        let t = start.elapsed().as_secs_f64();
        println!("{} {:.2} s", line(o), t - last);
        last = t;
    })
    .unwrap();
    println!(
        "{} cases, {} failed, {} left out, mean square {:.3} of {}",
        s.cases,
        s.failed,
        s.left_out.len(),
        s.mean_square,
        s.noisy
    );
}
