//! Every instruction set against plain loops.

use super::{Bits, F32x8, Isa, Kernel, Mask, Simd, Simd8, SimdWide, dispatch};
use std::array::from_fn;

mod pictures;

/// One input of each kind a lane, in an order without pattern.
fn words(salt: u32) -> [u32; 16] {
    let mut x = 0x9e37_79b9u32.wrapping_mul(salt + 1);
    from_fn(|_| {
        x ^= x << 13;
        x ^= x >> 17;
        x ^= x << 5;
        x
    })
}

fn floats(salt: u32) -> [f32; 16] {
    words(salt).map(|x| (x >> 8) as f32 / 65536.0 - 128.0)
}

/// A number of turns with what random words give; of an interpreter, which is a thousand times slower, a few.
const fn turns(all: u32) -> u32 {
    if cfg!(miri) { all / 50 } else { all }
}

/// What a packet does in and out of memory, and all that the trait adds to a lane.
struct Everything;

impl Kernel for Everything {
    type Output = ();
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) {
        let width = P::WIDTH;
        for salt in 0..turns(200) {
            let (x, y) = (floats(salt), floats(salt + 1000));
            let (i, j) = (words(salt), words(salt + 2000));
            // Small differences and equal numbers as well.
            let j: [u32; 16] = from_fn(|k| if j[k] % 3 == 0 { i[k] } else { j[k] });
            let bits = words(salt + 3000)[0];
            let (px, py) = (<P as SimdWide>::load(&x), <P as SimdWide>::load(&y));
            let (pi, pj) = (P::load_bits(&i), P::load_bits(&j));
            let mask = P::mask(bits);
            let has = |k: usize| bits >> k & 1 != 0;
            let lanes = || 0..width;
            assert!(lanes().all(|k| mask.bits() >> k & 1 == bits >> k & 1));
            assert_eq!(P::mask(u32::MAX).bits(), ((1u64 << width) - 1) as u32);
            assert!(P::mask(u32::MAX).all() && !P::mask(0).any() && (!P::mask(0)).all());

            let mut out = [0.0; 16];
            SimdWide::store(P::select(mask, px, py), &mut out);
            assert!(lanes().all(|k| out[k] == if has(k) { x[k] } else { y[k] }));
            let mut out = [0; 16];
            P::store_bits(P::select_bits(mask, pi, pj), &mut out);
            assert!(lanes().all(|k| out[k] == if has(k) { i[k] } else { j[k] }));
            P::store_bits(pi.reverse_bits(), &mut out);
            assert!(lanes().all(|k| out[k] == i[k].reverse_bits()));

            let compare = |mask: P::Mask, f: &dyn Fn(usize) -> bool| {
                assert!(lanes().all(|k| (mask.bits() >> k & 1 != 0) == f(k)));
            };
            compare(P::equal_bits(pi, pj), &|k| i[k] == j[k]);
            compare(P::less_bits(pi, pj), &|k| i[k] < j[k]);
            compare(px.lt(py), &|k| x[k] < y[k]);

            let kept: Vec<usize> = lanes().filter(|&k| has(k)).collect();
            let (mut out, mut out_bits) = ([0.0; 16], [0; 16]);
            px.compress(mask, &mut out);
            P::compress_bits(pi, mask, &mut out_bits);
            for (place, &lane) in kept.iter().enumerate() {
                assert_eq!((out[place], out_bits[place]), (x[lane], i[lane]));
            }

            SimdWide::store(px.recip(), &mut out);
            let exact = |k: usize| 1.0 / f64::from(x[k]);
            let near = |k: usize| (f64::from(out[k]) / exact(k) - 1.0).abs() < 4.0 * 5.97e-8;
            assert!(lanes().filter(|&k| x[k] != 0.0).all(near));

            SimdWide::store(P::lookup(&y, pi), &mut out);
            assert!(lanes().all(|k| out[k] == y[i[k] as usize % 16]));
        }
    }
}

/// Every kind of number: zeros and infinities of both signs, NaN, what has no leading one, and some.
const KINDS: [f32; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-44,
    -1e-44,
    0.333_333_34,
    -7.5e3,
    1.000_000_1,
    6.1e-5,
];

/// What every lane does, against the same done by `f32`.
struct Exactly {
    isa: Option<Isa>,
}

impl Kernel for Exactly {
    type Output = ();
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) {
        let fused = !matches!(self.isa, None | Some(Isa::Portable));
        let load = |x: &[f32; 16]| <P as SimdWide>::load(x);
        alike::<P>(fused, load, |l, x| SimdWide::store(l, x));
        let load = |x: &[f32; 16]| <W as Simd8>::load(x[..8].try_into().expect("eight"));
        alike::<W>(fused, load, |l, x| x[..8].copy_from_slice(&Simd8::store(l)));
        let mut out = [0.0; 16];
        for set in 0..1u32 << P::WIDTH {
            load_all::<P>().compress(P::mask(set), &mut out);
            let kept = (0..P::WIDTH).filter(|k| set >> k & 1 != 0).map(|k| k as f32);
            assert!(out.iter().zip(kept).all(|(a, b)| *a == b), "{set:b}");
        }
    }
}

#[inline(always)]
fn load_all<P: SimdWide>() -> P {
    <P as SimdWide>::load(&from_fn::<f32, 16, _>(|k| k as f32))
}

/// Each operation on every pair of [`KINDS`]. One NaN is as good as another.
#[inline(always)]
fn alike<L: Simd>(fused: bool, load: impl Fn(&[f32; 16]) -> L, store: impl Fn(L, &mut [f32; 16])) {
    let same = |a: f32, b: f32| f32::to_bits(a) == f32::to_bits(b) || (a.is_nan() && b.is_nan());
    for turn in (0..16 * 16).step_by(if cfg!(miri) { 9 } else { 1 }) {
        // Every lane meets every kind, and beside it in time every other.
        let (x, y) =
            (from_fn(|k| KINDS[(k + turn) % 16]), from_fn(|k| KINDS[(k + turn / 16) % 16]));
        let z: [f32; 16] = from_fn(|k| KINDS[(3 * k + turn) % 16]);
        let (a, b, c) = (load(&x), load(&y), load(&z));
        let lanes = || 0..L::WIDTH;
        let check = |what: &str, found: L, f: &dyn Fn(f32, f32) -> f32| {
            let mut out = [0.0; 16];
            store(found, &mut out);
            for k in lanes() {
                let truth = f(x[k], y[k]);
                assert!(same(out[k], truth), "{what} of {} and {}: {}", x[k], y[k], out[k]);
            }
        };
        check("+", a + b, &|x, y| x + y);
        check("-", a - b, &|x, y| x - y);
        check("*", a * b, &|x, y| x * y);
        check("/", a / b, &|x, y| x / y);
        check("neg", -a, &|x, _| -x);
        check("abs", a.abs(), &|x, _| x.abs());
        check("sqrt", a.sqrt(), &|x, _| x.sqrt());
        check("sqr", a.sqr(), &|x, _| x * x);
        check("min", a.min(b), &|x, y| if x < y { x } else { y });
        check("max", a.max(b), &|x, y| if x > y { x } else { y });
        check("copysign", a.copysign(b), &|x, y| x.copysign(y));
        check("select", L::select(a.lt(b), a, b), &|x, y| if x < y { x } else { y });
        check("or_zero", a.or_zero(a.le(b)), &|x, y| if x <= y { x } else { 0.0 });
        let mut out = [0.0; 16];
        store(a.mul_add(b, c), &mut out);
        for k in lanes() {
            let twice = x[k] * y[k] + z[k];
            let truth = if fused { x[k].mul_add(y[k], z[k]) } else { twice };
            assert!(same(out[k], truth), "{} * {} + {}: {}", x[k], y[k], z[k], out[k]);
        }

        let compare = |what: &str, mask: L::Mask, f: &dyn Fn(f32, f32) -> bool| {
            let truth = lanes().fold(0, |bits, k| bits | u32::from(f(x[k], y[k])) << k);
            assert_eq!(mask.bits(), truth, "{what} of {x:?} and {y:?}");
            assert_eq!((mask.any(), mask.all()), (truth != 0, truth == ((1 << L::WIDTH) - 1)));
        };
        compare("<", a.lt(b), &|x, y| x < y);
        compare("<=", a.le(b), &|x, y| x <= y);
        compare(">", a.gt(b), &|x, y| x > y);
        compare(">=", a.ge(b), &|x, y| x >= y);
        compare("==", a.equal(b), &|x, y| x == y);
        compare("not", !a.lt(b), &|x, y| x >= y || x.is_nan() || y.is_nan());
        compare("and", a.le(b) & b.le(a), &|x, y| x == y);
        compare("or", a.lt(b) | a.equal(b), &|x, y| x <= y);
    }
    for salt in 0..turns(200) {
        let (i, j) = (words(salt), words(salt + 100));
        let of = |x: &[u32; 16]| load(&x.map(f32::from_bits)).to_bits();
        let (a, b) = (of(&i), of(&j));
        let check = |what: &str, found: L::Bits, f: &dyn Fn(u32, u32) -> u32| {
            let mut out = [0.0; 16];
            store(L::from_bits(found), &mut out);
            let found = out.map(f32::to_bits);
            assert!((0..L::WIDTH).all(|k| found[k] == f(i[k], j[k])), "{what}: {found:x?}");
        };
        check("+", a + b, &u32::wrapping_add);
        check("-", a - b, &u32::wrapping_sub);
        check("*", a * b, &u32::wrapping_mul);
        check("splat *", a * L::Bits::splat(0x9e37_79b9), &|i, _| i.wrapping_mul(0x9e37_79b9));
        check("&", a & b, &|i, j| i & j);
        check("|", a | b, &|i, j| i | j);
        check("^", a ^ b, &|i, j| i ^ j);
        check("<<", a << (salt % 32), &|i, _| i << (salt % 32));
        check(">>", a >> (salt % 32), &|i, _| i >> (salt % 32));
        check("reverse", a.reverse_bits(), &|i, _| i.reverse_bits());
        check("small", L::from_small(a >> 8).to_bits(), &|i, _| ((i >> 8) as f32).to_bits());
    }
}

/// What the traversal asks of eight lanes.
struct Choice;

impl Kernel for Choice {
    type Output = ();
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) {
        for salt in 0..turns(2000) {
            // Zeros and equal numbers among them; infinity comes from planes beyond a flat ray.
            let some = floats(salt);
            let numbers: [f32; 8] = from_fn(|k| match some[k] {
                x if x < -64.0 => 0.0,
                x if x < 0.0 => 2.5,
                x if x > 120.0 => f32::INFINITY,
                x => x,
            });
            let all = words(salt + 5000);
            let words: [u32; 8] = from_fn(|k| all[k]);
            let limit = [-1.0, 0.0, 2.5, 60.0, f32::INFINITY][salt as usize % 5];
            let mask = W::load(&numbers).le(W::splat(limit));
            let mut kept: Vec<usize> = (0..8).filter(|&k| numbers[k] <= limit).collect();

            let mut out = [0; 8];
            assert_eq!(W::pick(mask, &words, &mut out), kept.len());
            assert!(kept.iter().zip(out).all(|(&k, word)| words[k] == word));

            let (mut far, mut order) = ([0.0; 8], [0; 8]);
            assert_eq!(
                W::load(&numbers).sort_far_to_near(mask, &words, &mut far, &mut order),
                kept.len()
            );
            let cut = |x: f32| x.to_bits() & !15;
            kept.sort_by_key(|&k| std::cmp::Reverse((cut(numbers[k]), k)));
            for (place, &k) in kept.iter().enumerate() {
                assert_eq!((cut(far[place]), order[place]), (cut(numbers[k]), words[k]));
            }
            W::prefetch(&words);
        }
    }
}

/// Plain Rust, which not every target has in its portable set, and all sets of this machine.
#[test]
fn lanes_are_chosen_and_sorted_as_loops_do() {
    Choice.run::<F32x8, f32>();
    for isa in Isa::available() {
        dispatch(isa, Choice);
    }
}

#[test]
fn packets_do_what_loops_do() {
    Everything.run::<F32x8, f32>();
    for isa in Isa::available() {
        dispatch(isa, Everything);
    }
}

#[test]
fn every_lane_does_what_one_number_does() {
    Exactly { isa: None }.run::<F32x8, f32>();
    for isa in Isa::available() {
        dispatch(isa, Exactly { isa: Some(isa) });
    }
}

/// The portable set is as wide as the target's baseline.
#[test]
fn sets_are_as_wide_as_they_say() {
    let widths: Vec<usize> = Isa::available().into_iter().map(Isa::width).collect();
    let all: &[usize] = if cfg!(target_arch = "x86_64") {
        &[4, 8, 16, 16]
    } else if cfg!(target_arch = "aarch64") {
        &[4, 4]
    } else {
        &[1]
    };
    assert!(all.starts_with(&widths), "{widths:?}");
}

#[test]
fn every_set_up_to_the_best_is_available() {
    let sets = Isa::available();
    assert_eq!((sets[0], sets[sets.len() - 1]), (Isa::Portable, Isa::detect()));
    assert!(sets.len() <= Isa::ALL.len());
}
