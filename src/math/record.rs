//! Records with named fields that SIMD lanes read, each lane another one.
//!
//! [`gather_record!`] makes a struct over a SIMD type of a list of fields. Over `f32` it is one
//! record, to be built by name; over a wider type it is as many as there are lanes. A
//! [`GatherTable`](super::gather_table::GatherTable) holds records as rows of numbers; which number
//! is which is known here alone.

use super::simd::{Bits, Simd, SimdWide, U32};
use super::{Rgb, V3};
use std::marker::PhantomData;

/// What a field may be: a number, a word of 32 bits, an enum, a vector, a colour, another record, or
/// an array of one of these.
pub(crate) trait RecordField: Copy {
    /// How many numbers of a row it takes.
    const NUMBERS: usize;
    /// Its values in the lanes of a SIMD type; over `f32`, one value.
    type Lanes<L: Simd>: Copy;
    /// Writes one value to the start of a row.
    fn write(value: &Self::Lanes<f32>, row: &mut [f32]);
    /// Reads lanes from the start of a row.
    fn read<L: Simd>(row: &[L]) -> Self::Lanes<L>;
    /// One value in every lane.
    fn splat<L: Simd>(value: &Self::Lanes<f32>) -> Self::Lanes<L>;
}

impl RecordField for f32 {
    const NUMBERS: usize = 1;
    type Lanes<L: Simd> = L;
    fn write(value: &f32, row: &mut [f32]) {
        row[0] = *value;
    }
    #[inline(always)]
    fn read<L: Simd>(row: &[L]) -> L {
        row[0]
    }
    #[inline(always)]
    fn splat<L: Simd>(value: &f32) -> L {
        L::splat(*value)
    }
}

impl RecordField for u32 {
    const NUMBERS: usize = 1;
    type Lanes<L: Simd> = L::Bits;
    fn write(value: &U32, row: &mut [f32]) {
        row[0] = Simd::from_bits(*value);
    }
    #[inline(always)]
    fn read<L: Simd>(row: &[L]) -> L::Bits {
        row[0].to_bits()
    }
    #[inline(always)]
    fn splat<L: Simd>(value: &U32) -> L::Bits {
        L::Bits::splat(value.0)
    }
}

impl RecordField for V3 {
    const NUMBERS: usize = 3;
    type Lanes<L: Simd> = V3<L>;
    fn write(value: &V3, row: &mut [f32]) {
        row[..3].copy_from_slice(&[value.x, value.y, value.z]);
    }
    #[inline(always)]
    fn read<L: Simd>(row: &[L]) -> V3<L> {
        V3::new(row[0], row[1], row[2])
    }
    #[inline(always)]
    fn splat<L: Simd>(value: &V3) -> V3<L> {
        value.splat_lanes()
    }
}

impl RecordField for Rgb {
    const NUMBERS: usize = 3;
    type Lanes<L: Simd> = Rgb<L>;
    fn write(value: &Rgb, row: &mut [f32]) {
        row[..3].copy_from_slice(&[value.r, value.g, value.b]);
    }
    #[inline(always)]
    fn read<L: Simd>(row: &[L]) -> Rgb<L> {
        Rgb::new(row[0], row[1], row[2])
    }
    #[inline(always)]
    fn splat<L: Simd>(value: &Rgb) -> Rgb<L> {
        value.splat_lanes()
    }
}

impl<T: RecordField, const N: usize> RecordField for [T; N] {
    const NUMBERS: usize = N * T::NUMBERS;
    type Lanes<L: Simd> = [T::Lanes<L>; N];
    fn write(value: &[T::Lanes<f32>; N], row: &mut [f32]) {
        for (value, row) in value.iter().zip(row.chunks_exact_mut(T::NUMBERS)) {
            T::write(value, row);
        }
    }
    #[inline(always)]
    fn read<L: Simd>(row: &[L]) -> [T::Lanes<L>; N] {
        // No closure: what a closure does is not always compiled for the instruction set around it.
        let mut found = [T::read(row); N];
        for i in 1..N {
            found[i] = T::read(&row[i * T::NUMBERS..]);
        }
        found
    }
    #[inline(always)]
    fn splat<L: Simd>(value: &[T::Lanes<f32>; N]) -> [T::Lanes<L>; N] {
        let mut found = [T::splat::<L>(&value[0]); N];
        for i in 1..N {
            found[i] = T::splat::<L>(&value[i]);
        }
        found
    }
}

/// An enum without data, of which a record has one.
pub(crate) trait RecordKind: Copy {
    /// The number that stands for it.
    fn number(self) -> u32;
}

/// An enum's value in each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KindLanes<K, L: Simd> {
    numbers: L::Bits,
    of: PhantomData<K>,
}

impl<K: RecordKind> KindLanes<K, f32> {
    pub(crate) fn new(kind: K) -> KindLanes<K, f32> {
        KindLanes { numbers: Bits::splat(kind.number()), of: PhantomData }
    }
}

impl<K: RecordKind, P: SimdWide> KindLanes<K, P> {
    /// Where it is this one.
    #[inline(always)]
    pub(crate) fn is(self, kind: K) -> P::Mask {
        P::equal_bits(self.numbers, P::Bits::splat(kind.number()))
    }
}

impl<K: RecordKind> RecordField for K {
    const NUMBERS: usize = 1;
    type Lanes<L: Simd> = KindLanes<K, L>;
    fn write(value: &KindLanes<K, f32>, row: &mut [f32]) {
        u32::write(&value.numbers, row);
    }
    #[inline(always)]
    fn read<L: Simd>(row: &[L]) -> KindLanes<K, L> {
        KindLanes { numbers: u32::read(row), of: PhantomData }
    }
    #[inline(always)]
    fn splat<L: Simd>(value: &KindLanes<K, f32>) -> KindLanes<K, L> {
        KindLanes { numbers: u32::splat::<L>(&value.numbers), of: PhantomData }
    }
}

/// Makes a record of fields, each of which is a [`RecordField`]: `struct Name<L>`, over `f32` if nothing
/// else is said.
macro_rules! gather_record {
    (
        $(#[$about:meta])*
        $vis:vis struct $name:ident {
            $($(#[$about_field:meta])* $vis_field:vis $field:ident: $of:ty,)*
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug)]
        $vis struct $name<L: $crate::math::simd::Simd = f32> {
            $(
                $(#[$about_field])*
                $vis_field $field: <$of as $crate::math::record::RecordField>::Lanes<L>,
            )*
        }

        impl $crate::math::record::RecordField for $name {
            const NUMBERS: usize = 0 $(+ <$of as $crate::math::record::RecordField>::NUMBERS)*;
            type Lanes<L: $crate::math::simd::Simd> = $name<L>;
            fn write(value: &$name, row: &mut [f32]) {
                let mut rest = row;
                $(
                    <$of as $crate::math::record::RecordField>::write(&value.$field, rest);
                    rest = &mut rest[<$of as $crate::math::record::RecordField>::NUMBERS..];
                )*
                let _ = rest;
            }
            #[inline(always)]
            fn read<L: $crate::math::simd::Simd>(row: &[L]) -> $name<L> {
                let rest = row;
                $(
                    let $field = <$of as $crate::math::record::RecordField>::read(rest);
                    let rest = &rest[<$of as $crate::math::record::RecordField>::NUMBERS..];
                )*
                let _ = rest;
                $name { $($field),* }
            }
            #[inline(always)]
            fn splat<L: $crate::math::simd::Simd>(value: &$name) -> $name<L> {
                $name {
                    $($field: <$of as $crate::math::record::RecordField>::splat::<L>(&value.$field),)*
                }
            }
        }
    };
}
pub(crate) use gather_record;

#[cfg(test)]
mod tests {
    use super::super::gather_table::GatherTable;
    use super::*;
    use crate::math::simd::{Isa, Kernel, Mask, Simd8, dispatch};

    #[derive(Clone, Copy, Debug)]
    #[repr(u32)]
    enum Colour {
        Red = 7,
        Blue = 0xffff_ffff,
    }

    impl RecordKind for Colour {
        #[inline(always)]
        fn number(self) -> u32 {
            self as u32
        }
    }

    gather_record! {
        struct Inner {
            at: V3,
            size: f32,
        }
    }

    gather_record! {
        struct Outer {
            number: f32,
            colour: Colour,
            parts: [Inner; 2],
            words: [u32; 3],
            light: Rgb,
        }
    }

    /// The `i`th record: every number in it is another one, words are any bits.
    fn outer(i: u32) -> Outer {
        let x = |k: u32| (100 * i + k) as f32;
        let inner = |k: u32| Inner { at: V3::new(x(k), x(k + 1), x(k + 2)), size: x(k + 3) };
        Outer {
            number: x(0),
            colour: KindLanes::new(if i.is_multiple_of(3) { Colour::Blue } else { Colour::Red }),
            parts: [inner(1), inner(5)],
            words: [i, i << 20, !i].map(U32),
            light: Rgb::new(x(9), x(10), x(11)),
        }
    }

    struct Reads<'a>(&'a GatherTable<Outer, { Outer::NUMBERS }>, u32);

    impl Kernel for Reads<'_> {
        type Output = ();
        #[inline(always)]
        fn run<W: Simd8, P: SimdWide>(self) {
            let Reads(table, count) = self;
            let which: [u32; 16] = std::array::from_fn(|lane| (lane as u32 * 5 + 3) % count);
            let found = table.get::<P>(P::load_bits(&which));
            let lanes = |x: P| {
                let mut numbers = [0.0; 16];
                x.store(&mut numbers);
                numbers
            };
            let words = |x: P::Bits| {
                let mut numbers = [0; 16];
                P::store_bits(x, &mut numbers);
                numbers
            };
            for (lane, i) in which.into_iter().enumerate().take(P::WIDTH) {
                let one = outer(i);
                assert_eq!(lanes(found.number)[lane], one.number);
                for (part, one) in found.parts.iter().zip(one.parts) {
                    let V3 { x, y, z } = part.at;
                    assert_eq!([x, y, z].map(|x| lanes(x)[lane]), <[f32; 3]>::from(one.at));
                    assert_eq!(lanes(part.size)[lane], one.size);
                }
                assert_eq!(found.words.map(|x| words(x)[lane]), one.words.map(|w| w.0));
                let Rgb { r, g, b } = found.light;
                let light = [r, g, b].map(|x| lanes(x)[lane]);
                assert_eq!(light, [one.light.r, one.light.g, one.light.b]);
                let is = |colour| found.colour.is(colour).bits() >> lane & 1 != 0;
                assert_eq!(
                    [is(Colour::Blue), is(Colour::Red)],
                    [i.is_multiple_of(3), !i.is_multiple_of(3)]
                );
            }
        }
    }

    #[test]
    fn each_lane_reads_its_own_record_by_name() {
        for count in [1, 2, 16, 17, 40] {
            let table = GatherTable::new((0..count).map(outer).collect());
            for isa in Isa::available() {
                dispatch(isa, Reads(&table, count));
            }
            for i in 0..count {
                assert_eq!(
                    table.record(i as usize).words.map(|w| w.0),
                    outer(i).words.map(|w| w.0)
                );
            }
        }
    }
}
