//! Small tables read by many lanes at once, each with an index of its own.

use super::record::RecordField;
use super::simd::{MAX_WIDTH, SimdWide};
use std::array::from_fn;
use std::marker::PhantomData;

/// Entries of a table for [`SimdWide::lookup`].
const LOOKUP: usize = 16;

/// Records `R` as rows of `N` numbers, which is [`RecordField::NUMBERS`] of `R`. Up to sixteen are kept
/// by field and read within registers; of more, each lane's record is fetched by itself.
#[derive(Clone, Debug)]
pub(crate) struct GatherTable<R, const N: usize> {
    rows: Vec<[f32; N]>,
    by_field: Option<Box<[[f32; LOOKUP]; N]>>,
    of: PhantomData<R>,
}

impl<R: RecordField, const N: usize> GatherTable<R, N> {
    pub(crate) fn new(records: Vec<R::Lanes<f32>>) -> GatherTable<R, N> {
        const { assert!(N == R::NUMBERS, "a row has the numbers of a record") };
        let row = |record| {
            let mut row = [0.0; N];
            R::write(record, &mut row);
            row
        };
        let rows: Vec<[f32; N]> = records.iter().map(row).collect();
        let by_field = (rows.len() <= LOOKUP)
            .then(|| Box::new(from_fn(|field| from_fn(|i| rows.get(i).map_or(0.0, |r| r[field])))));
        GatherTable { rows, by_field, of: PhantomData }
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// One record.
    #[inline(always)]
    pub(crate) fn record(&self, index: usize) -> R::Lanes<f32> {
        R::read(&self.rows[index])
    }

    /// The records that the lanes name. What an index beyond the table gives is of no use, but
    /// gives no fault either.
    #[inline(always)]
    pub(crate) fn get<P: SimdWide>(&self, index: P::Bits) -> R::Lanes<P> {
        self.get_some::<P>(index, u32::MAX)
    }

    /// The records that these lanes name; the others' are anything.
    #[inline(always)]
    pub(crate) fn get_some<P: SimdWide>(&self, index: P::Bits, lanes: u32) -> R::Lanes<P> {
        let mut found = [P::splat(0.0); N];
        if let Some(fields) = &self.by_field {
            for (found, field) in found.iter_mut().zip(fields.iter()) {
                *found = P::lookup(field, index);
            }
            return R::read(&found);
        }
        let mut which = [0; MAX_WIDTH];
        P::store_bits(index, &mut which);
        let mut fields = [[0.0; MAX_WIDTH]; N];
        for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
            let row = self.rows.get(which[lane] as usize).unwrap_or(&self.rows[0]);
            for field in 0..N {
                fields[field][lane] = row[field];
            }
        }
        for (found, field) in found.iter_mut().zip(&fields) {
            *found = P::load(field);
        }
        R::read(&found)
    }
}
