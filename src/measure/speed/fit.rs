//! The straight line through points, by least squares.

/// A line's slope and how well the points determine it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Rise of y for each unit of x.
    pub slope: f64,
    /// Its standard error from the distances of the points to the line, which holds if those are
    /// independent; NaN for two points, which tell nothing of it.
    pub standard_error: f64,
}

impl Fit {
    /// The slope b of y = a + b x with the least sum of squared distances in y. Points with a
    /// coordinate that is not finite are left out; `None` if fewer than two different x are left.
    pub fn line(points: impl IntoIterator<Item = [f64; 2]>) -> Option<Fit> {
        let finite = |p: &[f64; 2]| p.iter().all(|c| c.is_finite());
        let points: Vec<[f64; 2]> = points.into_iter().filter(finite).collect();
        let n = points.len() as f64;
        let mean = |c: usize| points.iter().map(|p| p[c]).sum::<f64>() / n;
        let [mx, my] = [mean(0), mean(1)];
        let sxx: f64 = points.iter().map(|p| (p[0] - mx).powi(2)).sum();
        let sxy: f64 = points.iter().map(|p| (p[0] - mx) * (p[1] - my)).sum();
        let known = points.len() >= 2 && sxx > 0.0;
        known.then(|| {
            let slope = sxy / sxx;
            let rest = |p: &[f64; 2]| (p[1] - my - slope * (p[0] - mx)).powi(2);
            let left: f64 = points.iter().map(rest).sum();
            Fit { slope, standard_error: (left / (n - 2.0) / sxx).sqrt() }
        })
    }
}
