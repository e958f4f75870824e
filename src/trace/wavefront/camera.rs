//! Camera rays.

use super::PathBatch;
use crate::geometry::NO_SURFACE;
use crate::math::V3;
use crate::math::simd::{Bits, Kernel, MAX_WIDTH, Simd8, SimdWide, first_lanes};
use crate::math::sobol::{Slot, Stream, pair};
use crate::trace::Tracer;

/// Makes the camera rays of the batch's pixels, blocks of `block` times `block` pixels each.
pub(super) struct GenerateCameraRays<'a> {
    pub(super) tracer: &'a Tracer,
    pub(super) batch: &'a mut PathBatch,
    pub(super) count: usize,
    pub(super) block: u32,
}

impl Kernel for GenerateCameraRays<'_> {
    type Output = ();
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) {
        let GenerateCameraRays { tracer, batch, count, block } = self;
        let PathBatch { pixels: [columns, rows], paths, salts, split_rays, .. } = batch;
        let emitter_boxes =
            if split_rays.wanted { tracer.emitter_boxes(block) } else { Vec::new() };
        let side = P::splat(block as f32);
        let eye = tracer.camera.eye().splat_lanes::<P>();
        for at in (0..count).step_by(P::WIDTH) {
            let (x, y) = (columns.load::<P>(at), rows.load::<P>(at));
            let (salt, index) = (salts.load::<P>(at), paths.index.load::<P>(at));
            let stream = Stream::of_pixels(x, y, salt, index);
            let [dx, dy] = pair::<P>(&stream, Slot::CAMERA);
            let d = tracer
                .camera
                .direction((P::from_small(x) + dx) * side, (P::from_small(y) + dy) * side);
            paths.o.store(at, eye);
            paths.d.store(at, d);
            paths.beta.store(at, V3::splat(P::splat(1.0)));
            let mut mis_fraction = P::splat(1.0);
            if !emitter_boxes.is_empty() {
                let live = P::mask(first_lanes(count - at));
                let place = [P::from_small(x), P::from_small(y)];
                let slots: [u32; MAX_WIDTH] = std::array::from_fn(|lane| (at + lane) as u32);
                let path = (P::load_bits(&slots), &stream);
                mis_fraction =
                    tracer.split_camera_rays(split_rays, &emitter_boxes, live, place, side, path);
            }
            paths.mis_fraction.store(at, mis_fraction);
            paths.surface_id.store::<P>(at, P::Bits::splat(NO_SURFACE));
            paths.key.store::<P>(at, stream.key());
            paths.lead.store::<P>(at, P::Bits::splat(0));
        }
        for (slot, place) in paths.slot.0.iter_mut().zip(0..count as u32) {
            *slot = place;
        }
    }
}
