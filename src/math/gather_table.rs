//! Small tables read by many lanes at once, each with an index of its own.

use super::simd::SimdWide;
use std::array::from_fn;

/// Records of `N` numbers each. Up to sixteen are kept by field and read within registers; of more,
/// each lane's record is fetched by itself.
#[derive(Clone, Debug)]
pub(crate) struct GatherTable<const N: usize> {
    records: Vec<[f32; N]>,
    by_field: Option<Box<[[f32; 16]; N]>>,
}

impl<const N: usize> GatherTable<N> {
    pub(crate) fn new(records: Vec<[f32; N]>) -> GatherTable<N> {
        let by_field = (records.len() <= 16).then(|| {
            Box::new(from_fn(|field| from_fn(|i| records.get(i).map_or(0.0, |r| r[field]))))
        });
        GatherTable { records, by_field }
    }

    pub(crate) fn len(&self) -> usize {
        self.records.len()
    }

    /// One record.
    #[inline(always)]
    pub(crate) fn record(&self, index: usize) -> &[f32; N] {
        &self.records[index]
    }

    /// The records that the lanes name. What an index beyond the table gives is of no use, but
    /// gives no fault either.
    #[inline(always)]
    pub(crate) fn get<P: SimdWide>(&self, index: P::Bits) -> [P; N] {
        self.get_some(index, u32::MAX)
    }

    /// The records that these lanes name; the others' are anything.
    #[inline(always)]
    pub(crate) fn get_some<P: SimdWide>(&self, index: P::Bits, lanes: u32) -> [P; N] {
        let mut found = [P::splat(0.0); N];
        if let Some(fields) = &self.by_field {
            for (found, field) in found.iter_mut().zip(fields.iter()) {
                *found = P::lookup(field, index);
            }
            return found;
        }
        let mut which = [0; 16];
        P::store_bits(index, &mut which);
        let mut fields = [[0.0; 16]; N];
        for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
            let record = self.records.get(which[lane] as usize).unwrap_or(&self.records[0]);
            for field in 0..N {
                fields[field][lane] = record[field];
            }
        }
        for (found, field) in found.iter_mut().zip(&fields) {
            *found = P::load(field);
        }
        found
    }
}
