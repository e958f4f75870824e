//! The Khronos PBR Neutral tone mapper (specification of 2024, by Emmett Lalish): what it does to a
//! colour before the display's transfer curve.

/// Where compression begins: 0.8 less the reflectance of a dielectric.
const START: f32 = 0.8 - DIELECTRIC;
/// The reflectance of a dielectric at normal incidence, which is in all channels alike.
const DIELECTRIC: f32 = 0.04;
/// How fast compressed colours turn to white.
const DESATURATION: f32 = 0.15;
/// Beyond this all that is left to see is white; it keeps the quotients away from infinity.
const BRIGHTEST: f32 = 1e9;

/// Display light in 0..=1 from exposed radiance, none of it NaN; what is negative counts as 0.
#[inline(always)]
pub(super) fn mix(exposed: [f32; 3]) -> [f32; 3] {
    let [r, g, b] = exposed.map(|c| c.clamp(0.0, BRIGHTEST));
    let least = r.min(g).min(b);
    // A parabola up to twice the offset, where it is level.
    let narrow = 1.0 / (4.0 * DIELECTRIC);
    let offset = if least < 2.0 * DIELECTRIC { least - narrow * least * least } else { DIELECTRIC };
    let colour = [r - offset, g - offset, b - offset];
    let peak = colour[0].max(colour[1]).max(colour[2]);
    if peak < START {
        return colour;
    }
    let room = 1.0 - START;
    let lowered = 1.0 - room * room / (peak + room - START);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - lowered) + 1.0);
    let scale = lowered / peak;
    colour.map(|c| c * scale + (lowered - c * scale) * white)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The specification's steps, one by one, in double precision.
    fn as_specified(colour: [f64; 3]) -> [f64; 3] {
        let (f90, ks, kd) = (0.04, 0.8 - 0.04, 0.15);
        let x = colour[0].min(colour[1]).min(colour[2]);
        let f = if x <= 2.0 * f90 { x - x * x / (4.0 * f90) } else { 0.04 };
        let p = colour[0].max(colour[1]).max(colour[2]) - f;
        let c = colour.map(|c| c - f);
        if p <= ks {
            return c;
        }
        let pn = 1.0 - (1.0 - ks).powi(2) / (p + 1.0 - 2.0 * ks);
        let g = 1.0 / (kd * (p - pn) + 1.0);
        c.map(|c| c * pn / p * g + pn * (1.0 - g))
    }

    #[test]
    fn the_quick_way_is_the_specification() {
        let level = |i: i32| if i < 0 { 0.0 } else { (1.7f64).powi(i - 18) };
        for (r, g, b) in
            (-1..40).flat_map(|r| (-1..40).map(move |g| (r, g, (r * 31 + g * 17) % 37)))
        {
            let colour = [level(r), level(g), level(b)];
            let (quick, exact) = (mix(colour.map(|c| c as f32)), as_specified(colour));
            for (quick, exact) in quick.into_iter().zip(exact) {
                assert!((f64::from(quick) - exact).abs() < 2e-5, "{colour:?}: {quick} {exact}");
                assert!((0.0..=1.0).contains(&quick), "{colour:?}: {quick}");
            }
        }
    }

    #[test]
    fn highlights_keep_their_order_and_their_hue() {
        let mut before = 0.0;
        for i in 0..400 {
            let x = 0.02 * (1.05f32).powi(i);
            let [r, g, b] = mix([x, 0.5 * x, 0.25 * x]);
            assert!(r > before || r > 0.9999, "{x}: {r} after {before}");
            assert!(r >= g && g >= b, "{x}");
            before = r;
        }
        // Published figures: 0.8 is as bright as 0.76 after the offset, where compression begins.
        let [grey, ..] = mix([0.8; 3]);
        assert!((grey - 0.76).abs() < 1e-6);
        assert_eq!(mix([0.0, -1.0, f32::NEG_INFINITY]), [0.0; 3]);
        assert_eq!(mix([f32::INFINITY; 3]), [1.0; 3]);
    }
}
