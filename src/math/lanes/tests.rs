//! Every instruction set against plain loops.

use super::{Bits, Isa, Kernel, Mask, Packet, Wide, dispatch};

/// One input of each kind a lane, in an order without pattern.
fn words(salt: u32) -> [u32; 16] {
    let mut x = 0x9e37_79b9u32.wrapping_mul(salt + 1);
    std::array::from_fn(|_| {
        x ^= x << 13;
        x ^= x >> 17;
        x ^= x << 5;
        x
    })
}

fn floats(salt: u32) -> [f32; 16] {
    words(salt).map(|x| (x >> 8) as f32 / 65536.0 - 128.0)
}

/// What a packet does in and out of memory, and all that the trait adds to a lane.
struct Everything;

impl Kernel for Everything {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) {
        let width = P::WIDTH;
        for salt in 0..200 {
            let (x, y) = (floats(salt), floats(salt + 1000));
            let (i, j) = (words(salt), words(salt + 2000));
            // Small differences and equal numbers as well.
            let j: [u32; 16] = std::array::from_fn(|k| if j[k] % 3 == 0 { i[k] } else { j[k] });
            let bits = words(salt + 3000)[0];
            let (px, py) = (<P as Packet>::load(&x), <P as Packet>::load(&y));
            let (pi, pj) = (P::load_bits(&i), P::load_bits(&j));
            let mask = P::mask(bits);
            let has = |k: usize| bits >> k & 1 != 0;
            let lanes = || 0..width;
            assert!(lanes().all(|k| mask.bits() >> k & 1 == bits >> k & 1));
            assert_eq!(P::mask(u32::MAX).bits(), ((1u64 << width) - 1) as u32);
            assert!(P::mask(u32::MAX).all() && !P::mask(0).any() && (!P::mask(0)).all());

            let mut out = [0.0; 16];
            Packet::store(P::select(mask, px, py), &mut out);
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

            Packet::store(px.recip(), &mut out);
            let exact = |k: usize| 1.0 / f64::from(x[k]);
            let near = |k: usize| (f64::from(out[k]) / exact(k) - 1.0).abs() < 4.0 * 5.97e-8;
            assert!(lanes().filter(|&k| x[k] != 0.0).all(near));

            let index = i.map(|i| i % 16);
            Packet::store(P::lookup(&y, P::load_bits(&index)), &mut out);
            assert!(lanes().all(|k| out[k] == y[index[k] as usize]));
        }
    }
}

/// What the traversal asks of eight lanes.
struct Choice;

impl Kernel for Choice {
    type Output = ();
    #[inline(always)]
    fn run<W: Wide, P: Packet>(self) {
        for salt in 0..2000 {
            // Zeros and equal numbers among them; infinity comes from planes beyond a flat ray.
            let some = floats(salt);
            let numbers: [f32; 8] = std::array::from_fn(|k| match some[k] {
                x if x < -64.0 => 0.0,
                x if x < 0.0 => 2.5,
                x if x > 120.0 => f32::INFINITY,
                x => x,
            });
            let all = words(salt + 5000);
            let words: [u32; 8] = std::array::from_fn(|k| all[k]);
            let limit = [-1.0, 0.0, 2.5, 60.0, f32::INFINITY][salt as usize % 5];
            let mask = W::load(&numbers).le(W::splat(limit));
            let mut kept: Vec<usize> = (0..8).filter(|&k| numbers[k] <= limit).collect();

            let mut out = [0; 8];
            assert_eq!(W::pick(mask, &words, &mut out), kept.len());
            assert!(kept.iter().zip(out).all(|(&k, word)| words[k] == word));

            let (mut far, mut order) = ([0.0; 8], [0; 8]);
            assert_eq!(W::load(&numbers).far_first(mask, &words, &mut far, &mut order), kept.len());
            let cut = |x: f32| x.to_bits() & !15;
            kept.sort_by_key(|&k| std::cmp::Reverse((cut(numbers[k]), k)));
            for (place, &k) in kept.iter().enumerate() {
                assert_eq!((cut(far[place]), order[place]), (cut(numbers[k]), words[k]));
            }
            W::prefetch(&words);
        }
    }
}

#[test]
fn lanes_are_chosen_and_sorted_as_loops_do() {
    for isa in Isa::available() {
        dispatch(isa, Choice);
    }
}

#[test]
fn packets_do_what_loops_do() {
    for isa in Isa::available() {
        dispatch(isa, Everything);
    }
}

#[test]
fn every_set_up_to_the_best_is_available() {
    let sets = Isa::available();
    assert_eq!((sets[0], sets[sets.len() - 1]), (Isa::Portable, Isa::detect()));
    assert!(sets.len() <= Isa::ALL.len());
}
