//! Light to and fro, by Nyström's method: the integral equation at Gauss points.

use super::ExactError;
use super::glossy::Finish;
use super::lobes::SeenLobe;
use crate::measure::check::quadrature::gauss;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Two unit squares over each other, of these albedos, of which the lower one emits 1: the radiance
/// that leaves their middles towards each other, by `points` points a side. Every bounce leaves
/// less than the product of the albedos, so that the series is summed to the end.
pub(super) fn parallel_planes(height: f64, albedo: [f64; 2], points: usize) -> [f64; 2] {
    let rule = gauss(points);
    let places: Vec<[f64; 3]> = rule
        .iter()
        .flat_map(|&[x, a]| rule.iter().map(move |&[y, b]| [x - 0.5, y - 0.5, a * b]))
        .collect();
    let h2 = height * height;
    // What a place gets from all of the other plate.
    let kernel = |x: f64, y: f64, light: &[f64]| -> f64 {
        let term = |(p, light): (&[f64; 3], &f64)| {
            let d2 = (p[0] - x).powi(2) + (p[1] - y).powi(2) + h2;
            light * p[2] / (d2 * d2)
        };
        places.iter().zip(light).map(term).sum::<f64>() * h2 / PI
    };
    let across = |light: &[f64], albedo: f64| -> Vec<f64> {
        places.iter().map(|p| albedo * kernel(p[0], p[1], light)).collect()
    };
    let mut lower = vec![1.0; places.len()];
    let mut upper = vec![0.0; places.len()];
    let (mut news, mut largest) = (lower.clone(), 1.0);
    while largest > 1e-15 {
        let up = across(&news, albedo[1]);
        let down = across(&up, albedo[0]);
        upper.iter_mut().zip(&up).for_each(|(sum, x)| *sum += x);
        lower.iter_mut().zip(&down).for_each(|(sum, x)| *sum += x);
        largest = down.iter().fold(0.0, |a: f64, &b| a.max(b));
        news = down;
    }
    [1.0 + albedo[0] * kernel(0.0, 0.0, &upper), albedo[1] * kernel(0.0, 0.0, &lower)]
}

/// The inside of a sphere of this finish that emits 1, seen at the cosine `mu`: a chord meets the
/// wall at the same angle at both ends, so that radiance is a function of the cosine alone. Cosines
/// by `points` points, azimuths by `azimuths` in each of ten panels that halve towards the mirror's.
/// `None` where light grows from bounce to bounce.
pub(super) fn cavity(
    finish: &Finish,
    mu: f64,
    points: usize,
    azimuths: usize,
) -> Result<Option<f64>, ExactError> {
    let angles: Vec<[f64; 3]> = gauss(points)
        .iter()
        .map(|&[x, weight]| {
            let (sin, cos) = (x * FRAC_PI_2).sin_cos();
            [sin, cos, weight * FRAC_PI_2 * sin]
        })
        .collect();
    let mut turns = Vec::new();
    for panel in 0..10 {
        let to = PI * 0.5f64.powi(panel);
        let from = if panel == 9 { 0.0 } else { 0.5 * to };
        turns.extend(gauss(azimuths).iter().map(|&[x, weight]| {
            let (sin, cos) = (from + (to - from) * x).sin_cos();
            [sin, cos, (to - from) * weight]
        }));
    }
    let row = |mu: f64| -> Result<Vec<f64>, ExactError> {
        let seen = SeenLobe::new(finish, mu)?;
        let ring = |&[sin, cos, weight]: &[f64; 3]| {
            let term = |&[s, c, w]: &[f64; 3]| seen.of(DVec3::new(-sin * c, sin * s, cos)) * w;
            2.0 * weight * turns.iter().map(term).sum::<f64>()
        };
        Ok(angles.iter().map(ring).collect())
    };
    let rows: Vec<Vec<f64>> = angles.iter().map(|a| row(a[1])).collect::<Result<_, _>>()?;
    let dot = |row: &[f64], light: &[f64]| row.iter().zip(light).map(|(a, b)| a * b).sum::<f64>();
    let mut light = vec![1.0; angles.len()];
    let mut news = light.clone();
    for _ in 0..3000 {
        news = rows.iter().map(|row| dot(row, &news)).collect();
        light.iter_mut().zip(&news).for_each(|(sum, x)| *sum += x);
        if news.iter().all(|&x| x < 1e-14) {
            return Ok(Some(1.0 + dot(&row(mu)?, &light)));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two plates of the case that showed an emitter lighting itself, to the digits that others
    /// computed by 26 and by 40 points a side.
    #[test]
    fn plates_at_no_round_height_have_the_known_radiance() {
        let [lower, upper] = parallel_planes(1.3, [0.7, 0.5], 26).map(|of_one| 2.0 * of_one);
        assert!((lower - 2.015_469_83).abs() < 5.1e-9, "{lower}");
        assert!((upper - 0.158_604_12).abs() < 5.1e-9, "{upper}");
    }
}
