//! scratch
use burnish::measure::calibrate::*;
use burnish::progressive::*;
use burnish::scene::builtin::Example;
use std::sync::Arc;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n: u64 = a[2].parse().unwrap();
    let w: u32 = a[3].parse().unwrap();
    let scene = Arc::new(Example::named(&a[1]).unwrap().read().unwrap().0.build());
    let mut p = Params::new(scene);
    p.size = [w, w * 3 / 4];
    let t = std::time::Instant::now();
    let r = Renders::new(&p, &[8, 16, 32, 64, 256], n, &mut |_| {}).unwrap();
    println!("{} {:.0} s", a[1], t.elapsed().as_secs_f64());
    for c in r.calibrations() {
        println!("{c:?}");
    }
    for k in [2usize, 3, 4] {
        let e = r.calibrations()[k].relative * 1.1;
        println!("{:?}", r.stopped(e, n, &mut |_| {}).unwrap());
    }
    println!(
        "cost {:.3} {:.3} {:.0} s",
        r.cost_of_replicates(64, 8),
        r.cost_of_replicates(256, 4),
        t.elapsed().as_secs_f64()
    );
}
